//! The best bound of a form on a region: ascent over the choices that a [pass](super::backward)
//! leaves, by Adam (Kingma and Ba 2015), as α,β-CROWN does (Xu et al. 2021, Wang et al. 2021).

use super::backward::{Frame, Least, Pass};
use super::propagation::{NeuronBounds, Phase, Unbounded, in_time};
use super::side::Choice;
use cede_nnv_check::proof::{Refutation, Tightening};
use cede_nnv_check::{Activation, InputBox};
use std::ops::Range;
use std::time::Instant;

/// First length of a step of the multipliers, as a part of the largest coefficient beside them.
const MULTIPLIER_STEP: f64 = 0.2;
/// Passes before it is asked whether more are worthwhile.
const LEAST_PASSES: usize = 12;
/// Memory of the gradient and of its square.
const MEMORY: [f64; 2] = [0.9, 0.99];

/// A part of a query's box.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    pub(super) region: &'a InputBox,
    pub(super) bounds: &'a [NeuronBounds],
    pub(super) phases: &'a [Phase],
}

/// How hard to try to make a bound positive.
#[derive(Clone, Copy)]
pub(super) struct Effort {
    pub(super) passes: usize,
    /// Whether to go on where that does not look likely.
    pub(super) patient: bool,
    /// First length of a step of the slopes, and how steps shrink.
    pub(super) slope_step: f64,
    pub(super) shrinking: f64,
}

impl Effort {
    /// So many passes from the usual slopes on.
    pub(super) const fn afresh(passes: usize) -> Self {
        Self {
            passes,
            patient: true,
            slope_step: 0.2,
            shrinking: 0.96,
        }
    }

    /// So many passes from a choice that is best on a larger region.
    pub(super) const fn again(passes: usize) -> Self {
        Self {
            passes,
            patient: true,
            slope_step: 0.02,
            shrinking: 0.9,
        }
    }
}

/// Memory of the ascent.
#[derive(Default)]
pub(super) struct Dual {
    pub(super) pass: Pass,
    pub(super) choice: Choice,
    best: Choice,
    /// Running means of gradient and of its square, of the slopes and of the multipliers.
    slopes: Vec<[f64; 2]>,
    multipliers: Vec<[f64; 2]>,
    scales: Vec<f64>,
    step: i32,
}

impl Dual {
    /// The best bound that so many passes find for the weighted sum of these outputs of a layer
    /// (pre-activations, or atoms of a conjunction; the choice holds the weights), from a choice on.
    /// The choice is then the one that gives it.
    ///
    /// # Errors
    /// If the deadline passed.
    pub(super) fn bound(
        &mut self,
        frame: &Frame<'_>,
        part: Part<'_>,
        form: &(usize, Range<usize>),
        effort: Effort,
        deadline: Instant,
    ) -> Result<Least, Unbounded> {
        pulp::Arch::new().dispatch(Climb {
            dual: self,
            frame,
            part,
            form,
            effort,
            deadline,
        })
    }

    #[inline(always)]
    fn climb_up(
        &mut self,
        frame: &Frame<'_>,
        part: Part<'_>,
        form: &(usize, Range<usize>),
        effort: Effort,
        deadline: Instant,
    ) -> Result<Least, Unbounded> {
        self.step = 0;
        self.slopes.clear();
        self.slopes.resize(self.choice.slopes.len(), [0.0; 2]);
        self.multipliers.clear();
        self.multipliers
            .resize(self.choice.multipliers.len(), [0.0; 2]);
        self.scales.clear();
        let (mut best, mut undecided) = (f64::NEG_INFINITY, false);
        let mut first = None;
        let last = loop {
            in_time(Some(deadline))?;
            let last = self.evaluate(frame, part, form);
            undecided |= last.undecided;
            let first = *first.get_or_insert(last.bound);
            if last.bound > best || self.step == 0 {
                best = last.bound;
                self.best.clone_from(&self.choice);
            }
            let pass = self.step as usize + 1;
            // Not worth more passes if the gain so far, kept up, would not reach zero.
            let left = effort.passes.saturating_sub(pass) as f64 / pass as f64;
            let hopeless = best + (best - first) * left < 0.0;
            if best > 0.0
                || pass >= effort.passes
                || !effort.patient && pass >= LEAST_PASSES && hopeless
            {
                break last.bound;
            }
            self.pass.descend(frame, form.0, &self.choice.slopes);
            self.climb(frame, part, form, effort);
        };
        std::mem::swap(&mut self.choice, &mut self.best);
        if best > last {
            self.evaluate(frame, part, form);
        }
        Ok(Least {
            bound: best,
            undecided,
        })
    }

    /// The bound for the present choice.
    #[inline(always)]
    pub(super) fn evaluate(
        &mut self,
        frame: &Frame<'_>,
        part: Part<'_>,
        (layer, outputs): &(usize, Range<usize>),
    ) -> Least {
        self.pass.assume(part.phases, &self.choice.multipliers);
        self.pass.form(*layer)[outputs.clone()].copy_from_slice(&self.choice.weights);
        self.pass
            .least(frame, part.region, *layer, &self.choice.slopes)
    }

    /// The inputs at the relaxation's minimum of the last pass.
    pub(super) fn minimiser(&self) -> &[f64] {
        &self.pass.point
    }

    /// Enters a region and makes the choice fit it: slopes and multipliers are those given where
    /// they are, else the usual slopes and 0.
    pub(super) fn enter(
        &mut self,
        frame: &Frame<'_>,
        part: Part<'_>,
        from: Option<&Choice>,
        weights: impl Iterator<Item = f64>,
    ) {
        self.pass.enter(frame, part.bounds);
        match from {
            Some(from) => {
                self.choice.clone_from(from);
                for (slope, lines) in self.choice.slopes.iter_mut().zip(&self.pass.lines) {
                    if !lines.free {
                        *slope = lines.lower_slope;
                    }
                }
            }
            None => {
                self.choice.slopes = self.pass.usual_slopes();
                self.choice.multipliers.clear();
                self.choice.weights.clear();
                self.choice.weights.extend(weights);
            }
        }
        self.choice.multipliers.resize(part.phases.len(), 0.0);
    }

    /// One step along the supergradient at the minimiser that was found last.
    #[inline(always)]
    fn climb(
        &mut self,
        frame: &Frame<'_>,
        part: Part<'_>,
        form: &(usize, Range<usize>),
        effort: Effort,
    ) {
        let decay = effort.shrinking.powi(self.step);
        self.step += 1;
        let step = self.step;
        let advance = |moments: &mut [f64; 2], gradient: f64| {
            let [m, v] = moments;
            *m = MEMORY[0] * *m + (1.0 - MEMORY[0]) * gradient;
            *v = MEMORY[1] * *v + (1.0 - MEMORY[1]) * gradient * gradient;
            let (m, v) = (
                *m / (1.0 - MEMORY[0].powi(step)),
                *v / (1.0 - MEMORY[1].powi(step)),
            );
            if v > 0.0 { decay * m / v.sqrt() } else { 0.0 }
        };
        let lines = &self.pass.lines;
        for (index, layer) in frame.layers()[..form.0].iter().enumerate() {
            if layer.activation == Activation::Identity {
                continue;
            }
            let own = layer.first..layer.first + layer.outputs;
            let (after, values) = (&self.pass.after[index], &self.pass.values[index]);
            let all = self.choice.slopes[own.clone()]
                .iter_mut()
                .zip(&mut self.slopes[own.clone()]);
            for (((slope, moments), lines), (&c, &z)) in
                all.zip(&lines[own]).zip(after.iter().zip(values))
            {
                if lines.free {
                    let gradient = if c > 0.0 { c * z } else { 0.0 };
                    *slope =
                        (*slope + effort.slope_step * advance(moments, gradient)).clamp(0.0, 1.0);
                }
            }
        }
        let places = part
            .phases
            .iter()
            .map(|&(neuron, on)| (frame.place(neuron as usize), on));
        if self.scales.is_empty() {
            for &(neuron, _) in part.phases {
                let (layer, _) = frame.place(neuron as usize);
                let largest = self.pass.after[layer]
                    .iter()
                    .fold(0.0_f64, |m, c| m.max(c.abs()));
                self.scales.push(largest);
            }
        }
        let all = self
            .choice
            .multipliers
            .iter_mut()
            .zip(&mut self.multipliers)
            .zip(&self.scales);
        for (((multiplier, moments), scale), ((layer, i), on)) in all.zip(places) {
            let z = self.pass.values[layer][i];
            let gradient = if on { -z } else { z };
            *multiplier =
                (*multiplier + MULTIPLIER_STEP * scale * advance(moments, gradient)).max(0.0);
        }
        let excesses = &self.pass.values[form.0][form.1.clone()];
        super::objective::shift_weights(&mut self.choice.weights, excesses, 0.5 * decay);
    }

    /// Of the unstable ReLUs before a layer, what the relaxation of each may have cost the last pass,
    /// where it has.
    pub(super) fn costs(
        &self,
        frame: &Frame<'_>,
        layer: usize,
        bounds: &[NeuronBounds],
    ) -> Vec<(usize, f64)> {
        let mut costs = Vec::new();
        for (layer, after) in frame.layers()[..layer].iter().zip(&self.pass.after) {
            if layer.activation != Activation::Relu {
                continue;
            }
            for (neuron, &c) in (layer.first..).zip(after) {
                let (lines, (l, u)) = (&self.pass.lines[neuron], bounds[neuron]);
                let slope = self.choice.slopes[neuron];
                let cost = if c > 0.0 {
                    c * ((1.0 - slope) * u).max(-slope * l)
                } else {
                    -c * lines.upper_offset
                };
                if lines.free && cost > 0.0 {
                    costs.push((neuron, cost));
                }
            }
        }
        costs
    }

    /// The record of the choice that refutes a conjunction.
    pub(super) fn refutation(&self, part: Part<'_>, conjunction: u32, bound: f64) -> Refutation {
        Refutation {
            conjunction,
            weights: self.choice.weights.clone(),
            multipliers: self.multipliers_of(part),
            slopes: self.slopes_before(usize::MAX),
            bound,
        }
    }

    /// The record of the choice that bounds a side of a neuron.
    pub(super) fn tightening(&self, part: Part<'_>, neuron: usize, upper: bool) -> Tightening {
        Tightening {
            neuron: neuron as u32,
            upper,
            multipliers: self.multipliers_of(part),
            slopes: self.slopes_before(neuron),
        }
    }

    fn multipliers_of(&self, part: Part<'_>) -> Vec<(u32, f64)> {
        let all = part.phases.iter().zip(&self.choice.multipliers);
        let all = all.map(|(phase, &multiplier)| (phase.0, multiplier));
        all.filter(|&(_, multiplier)| multiplier > 0.0).collect()
    }

    /// The lower slopes of the unstable ReLUs before a neuron.
    fn slopes_before(&self, neuron: usize) -> Vec<(u32, f64)> {
        let all = (0_u32..).zip(&self.choice.slopes).zip(&self.pass.lines);
        let free = all.take(neuron).filter(|(_, lines)| lines.free);
        free.map(|((neuron, &slope), _)| (neuron, slope)).collect()
    }
}

/// [`Dual::bound`], compiled for the machine's vectors.
struct Climb<'a, 'f> {
    dual: &'a mut Dual,
    frame: &'a Frame<'f>,
    part: Part<'a>,
    form: &'a (usize, Range<usize>),
    effort: Effort,
    deadline: Instant,
}

impl pulp::NullaryFnOnce for Climb<'_, '_> {
    type Output = Result<Least, Unbounded>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        self.dual
            .climb_up(self.frame, self.part, self.form, self.effort, self.deadline)
    }
}
