//! How a policy answers a whole box of states: the range of its acceleration and of its slopes.

use super::Subject;
use super::enclosure::{Interval, STATE};
use super::gradient::gradient;
use super::search::{MOST, TANH, single_precision_margin};
use cede_formats::property::Setting;
use cede_nnv::Bounder;
use cede_nnv_check::{Activation, AffineEnclosure, InputBox};

/// Bounds a policy's acceleration on boxes of states, in one setting.
pub(crate) struct Response<'a> {
    subject: &'a Subject<'a>,
    setting: Setting,
    bounder: Bounder,
}

/// What is known of the acceleration (m/s², as the controller computes it) on a box.
pub(crate) struct Answer {
    /// Its range.
    pub(crate) range: Interval,
    /// Its range in the middle of the box: rounding alone.
    pub(crate) middle: Interval,
    /// The ranges of the exact acceleration's slopes by the state; a mean value holds with them.
    pub(crate) slopes: [Interval; STATE],
}

impl<'a> Response<'a> {
    pub(crate) fn new(subject: &'a Subject<'a>, setting: Setting) -> Self {
        Self {
            subject,
            setting,
            bounder: Bounder::new(&subject.network, None),
        }
    }

    /// The answer on a box.
    pub(crate) fn on(&self, sides: [Interval; STATE]) -> Answer {
        let region = InputBox {
            lower: sides.map(|s| s.lo).to_vec(),
            upper: sides.map(|s| s.hi).to_vec(),
        };
        let network = &self.subject.network;
        let enclosed = self.subject.features(&region, &self.setting);
        let features: Vec<AffineEnclosure> = enclosed.iter().map(|e| e.feature.clone()).collect();
        let mut bounds = self.bounder.unbounded();
        self.bounder
            .worker()
            .tighten(&region, &features, &mut bounds);
        let slopes: Vec<_> = enclosed.iter().map(|e| e.slopes).collect();
        let by_state = gradient(network, &bounds, &slopes);
        let rounding = single_precision_margin(
            network,
            &features,
            &region,
            &bounds,
            vec![0.0; features.len()],
        );

        let centre = sides.map(|s| Interval::point(s.middle()));
        let at_centre = InputBox {
            lower: centre.map(|c| c.lo).to_vec(),
            upper: centre.map(|c| c.lo).to_vec(),
        };
        let values: Vec<Interval> = self
            .subject
            .front(&at_centre, &self.setting)
            .iter()
            .map(|f| range(f, &at_centre))
            .collect();
        let middle = self.through(values, None).wider(rounding);
        let whole: Vec<Interval> = features.iter().map(|f| range(f, &region)).collect();
        let natural = self.through(whole, Some(&bounds)).wider(rounding);
        let mean =
            sides
                .iter()
                .zip(&centre)
                .zip(&by_state)
                .fold(middle, |sum, ((side, c), slope)| {
                    let step = side.sub(*c);
                    if step.magnitude() == 0.0 {
                        return sum;
                    }
                    sum.add(slope.mul(step))
                });
        let mean = natural.and(mean);
        let flattening = flattening(mean);
        Answer {
            range: squashed(mean),
            middle: squashed(middle),
            slopes: by_state.map(|slope| slope.mul(flattening).scale(MOST)),
        }
    }

    /// The mean by interval arithmetic, within what is known of the neurons.
    fn through(&self, mut values: Vec<Interval>, bounds: Option<&[(f64, f64)]>) -> Interval {
        let mut first = 0;
        for layer in self.subject.network.layers() {
            let sum = |i: usize| {
                let terms = layer.weights.row(i).iter().zip(&values);
                terms.fold(Interval::point(layer.bias[i]), |sum, (&w, x)| {
                    sum.add(x.scale(w))
                })
            };
            let relu = layer.activation == Activation::Relu;
            let after = |i: usize| {
                let mut z = sum(i);
                if !relu {
                    return z;
                }
                if let Some(&(l, u)) = bounds.and_then(|b| b.get(first + i)) {
                    z = z.and(Interval::new(l, u));
                }
                z.clamp(0.0, f64::INFINITY)
            };
            values = (0..layer.outputs()).map(after).collect();
            first += layer.outputs();
        }
        values[0]
    }
}

/// The feature's range on a box.
pub(super) fn range(feature: &AffineEnclosure, region: &InputBox) -> Interval {
    let sides = region.lower.iter().zip(&region.upper);
    feature
        .slopes
        .iter()
        .zip(sides)
        .fold(
            Interval::point(feature.constant),
            |sum, (&s, (&lo, &hi))| sum.add(Interval::new(lo, hi).scale(s)),
        )
        .wider(feature.radius)
}

/// 3·tanh with what its `f32` computation may add.
fn squashed(mean: Interval) -> Interval {
    Interval::new(MOST * mean.lo.tanh(), MOST * mean.hi.tanh())
        .wider(MOST * TANH)
        .clamp(-MOST, MOST)
}

/// The range of tanh′.
fn flattening(mean: Interval) -> Interval {
    let at = |x: f64| 1.0 - x.tanh() * x.tanh();
    let (a, b) = (at(mean.lo), at(mean.hi));
    let most = if mean.contains(0.0) { 1.0 } else { a.max(b) };
    Interval::new(a.min(b), most).wider(1e-15).clamp(0.0, 1.0)
}
