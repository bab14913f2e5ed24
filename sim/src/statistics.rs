//! The little statistics that the tables need.

mod interval;
mod logistic;

pub use interval::{Mean, Share};
pub use logistic::LogisticRegression;
