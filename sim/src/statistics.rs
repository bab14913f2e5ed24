//! The little statistics that the tables need.

mod bootstrap;
mod discrimination;
mod interval;
mod logistic;

pub use bootstrap::{by_group, mean_by_group};
pub use discrimination::area_under_curve;
pub use interval::{Mean, Share};
pub use logistic::LogisticRegression;
