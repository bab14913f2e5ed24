//! The little statistics that the tables need.

mod bootstrap;
mod interval;
mod logistic;

pub use bootstrap::mean_by_group;
pub use interval::{Mean, Share};
pub use logistic::LogisticRegression;
