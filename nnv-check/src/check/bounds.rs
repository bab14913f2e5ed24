//! Bounds of all neurons on a box, by a dense backward pass for each.

use super::number::Number;
use crate::enclosure::AffineEnclosure;
use crate::model::{Activation, Network};
use std::cmp::Ordering;

/// One side of a variable's range.
#[derive(Clone)]
pub(super) struct Side<N> {
    pub(super) value: N,
    /// Whether the value itself is excluded.
    pub(super) strict: bool,
}

/// Least and greatest value of a pre-activation, where they are known.
#[derive(Clone)]
pub(super) struct Range<N> {
    pub(super) lower: Option<N>,
    pub(super) upper: Option<N>,
}

/// A box and bounds of all pre-activations, layer by layer.
///
/// All values are multiples of 1/`unit`: so the box's sides may be fractions in exact arithmetic.
/// ReLU and linear maps keep that; biases are multiplied by it.
#[derive(Clone)]
pub(super) struct Bounds<'a, N> {
    pub(super) network: &'a Network,
    pub(super) region: Vec<[Side<N>; 2]>,
    pub(super) unit: N,
    /// The network's inputs on the region, where they are functions of its variables.
    pub(super) enclosures: Option<Vec<AffineEnclosure>>,
    pub(super) layers: Layers<N>,
    /// The index of each layer's first neuron among those with an activation, where it has one.
    first: Vec<Option<usize>>,
}

/// Bounds of all pre-activations, layer by layer.
pub(super) type Layers<N> = Vec<Vec<Range<N>>>;

/// A linear form: coefficients·x + constant.
pub(super) struct Form<N> {
    pub(super) coefficients: Vec<N>,
    pub(super) constant: N,
}

impl<N: Number> Form<N> {
    pub(super) fn zero(length: usize) -> Self {
        Self {
            coefficients: vec![N::zero(); length],
            constant: N::zero(),
        }
    }
}

/// What a pass backwards may choose; every choice is sound.
pub(super) trait Choice {
    /// The lower slope in [0, 1] of an unstable ReLU, if it is not to be the usual one.
    fn slope(&self, neuron: usize) -> Option<f64>;
    /// The multiple of a pre-activation that is added: of one sign or the other as a phase is
    /// assumed, so that the form does not grow.
    fn multiplier(&self, neuron: usize) -> f64;
}

/// The usual slopes, and no multipliers.
pub(super) struct Usual;

impl Choice for Usual {
    fn slope(&self, _: usize) -> Option<f64> {
        None
    }

    fn multiplier(&self, _: usize) -> f64 {
        0.0
    }
}

/// A form's lower bound on a box.
pub(super) struct Least<N> {
    pub(super) bound: N,
    /// Whether the form is even greater on the whole box, whose side is excluded.
    pub(super) strict: bool,
}

fn first_neurons(network: &Network) -> Vec<Option<usize>> {
    let mut count = 0;
    let first = network.layers().iter().map(|layer| {
        let start = (layer.activation != Activation::Identity).then_some(count);
        count += start.map_or(0, |_| layer.outputs());
        start
    });
    first.collect()
}

/// Layer and place in it of a neuron, counted over all neurons with an activation; `None` if there is
/// no such neuron.
fn place(first: &[Option<usize>], neuron: usize) -> Option<(usize, usize)> {
    let layers = first.iter().enumerate();
    let (layer, first) = layers
        .filter_map(|(i, f)| f.map(|f| (i, f)))
        .rfind(|(_, f)| *f <= neuron)?;
    Some((layer, neuron - first))
}

/// Assumes a phase of a ReLU, counted over all neurons with an activation; `None` if there is no
/// such neuron.
pub(super) fn assume<N: Number>(
    network: &Network,
    layers: &mut Layers<N>,
    neuron: usize,
    on: bool,
) -> Option<()> {
    let (layer, i) = place(&first_neurons(network), neuron)?;
    let Range { lower, upper } = layers[layer].get_mut(i)?;
    let zero = Some(N::zero());
    if on {
        *lower = better(lower.as_ref(), zero, N::greater);
    } else {
        *upper = better(upper.as_ref(), zero, lesser);
    }
    Some(())
}

impl<'a, N: Number> Bounds<'a, N> {
    /// A box before anything is known of the pre-activations.
    pub(super) fn new(
        network: &'a Network,
        region: Vec<[Side<N>; 2]>,
        unit: N,
        enclosures: Option<Vec<AffineEnclosure>>,
    ) -> Self {
        let unknown = Range {
            lower: None,
            upper: None,
        };
        let layers = network.layers().iter();
        Self {
            network,
            region,
            unit,
            enclosures,
            layers: layers.map(|l| vec![unknown.clone(); l.outputs()]).collect(),
            first: first_neurons(network),
        }
    }

    /// Tightens all bounds that matter to the box; false if they contradict each other.
    pub(super) fn tighten(&mut self) -> bool {
        for index in 0..self.network.layers().len() {
            let layer = &self.network.layers()[index];
            if layer.activation == Activation::Identity {
                continue;
            }
            for i in 0..layer.outputs() {
                let known = &self.layers[index][i];
                if layer.activation == Activation::Relu && (known.is_on() || known.is_off()) {
                    continue;
                }
                let (low, high) = (
                    self.side(index, i, false, &Usual),
                    self.side(index, i, true, &Usual),
                );
                if !self.meet(index, i, low, high) {
                    return false;
                }
            }
        }
        true
    }

    /// Tightens one side of a neuron's range, by these choices, if there is such a neuron; false if
    /// that contradicts the other side.
    pub(super) fn tighten_side(
        &mut self,
        neuron: usize,
        upper: bool,
        choice: &impl Choice,
    ) -> bool {
        let Some((index, i)) = place(&self.first, neuron) else {
            return true;
        };
        if i >= self.layers[index].len() {
            return true;
        }
        let found = self.side(index, i, upper, choice);
        let (low, high) = if upper { (None, found) } else { (found, None) };
        self.meet(index, i, low, high)
    }

    /// A bound of one side of a neuron's range.
    fn side(&self, index: usize, i: usize, upper: bool, choice: &impl Choice) -> Option<N> {
        let layer = &self.network.layers()[index];
        let sign = if upper { -1.0 } else { 1.0 };
        let mut form = Form::<N>::zero(layer.inputs());
        let factor = N::of(sign).times(&N::spread(layer.uncertainty)?);
        factor.add_scaled(&mut form.coefficients, layer.weights.row(i));
        form.constant = N::of(sign * layer.bias[i]).times(&self.unit);
        let bound = self.least(index, form, choice)?.bound;
        let bound = if upper { bound.negated() } else { bound };
        Some(bound).filter(N::is_known)
    }

    /// Adds what was found to a neuron's range; false if nothing is left of it.
    fn meet(&mut self, index: usize, i: usize, low: Option<N>, high: Option<N>) -> bool {
        let known = &self.layers[index][i];
        let lower = better(known.lower.as_ref(), low, N::greater);
        let upper = better(known.upper.as_ref(), high, lesser);
        if let (Some(l), Some(u)) = (&lower, &upper)
            && l.plus(&u.negated()).sign() == Some(Ordering::Greater)
        {
            return false;
        }
        self.layers[index][i] = Range { lower, upper };
        true
    }

    /// A lower bound of a form over what layer `index` takes: back through the layers before it,
    /// each activation replaced by a line, then over the box. `None` if nothing is known.
    pub(super) fn least(
        &self,
        index: usize,
        mut form: Form<N>,
        choice: &impl Choice,
    ) -> Option<Least<N>> {
        let layers = &self.network.layers()[..index];
        for (depth, layer) in layers.iter().enumerate().rev() {
            let spread = N::spread(layer.uncertainty)?;
            let mut before = Form::zero(layer.inputs());
            before.constant = form.constant;
            for (j, c) in form.coefficients.iter().enumerate() {
                let neuron = self.first[depth].map(|first| first + j);
                let slope = neuron.and_then(|n| choice.slope(n));
                let range = &self.layers[depth][j];
                let (factor, offset) = line(layer.activation, range, c, slope, &self.unit)?;
                let lambda = neuron.map_or(0.0, |n| choice.multiplier(n));
                let total = factor.plus(&N::of(lambda));
                before.constant = before.constant.plus(&offset);
                if total.sign() == Some(Ordering::Equal) {
                    continue;
                }
                let bias = total.times(&N::of(layer.bias[j])).times(&self.unit);
                before.constant = before.constant.plus(&bias);
                let total = total.times(&spread);
                if !total.is_known() {
                    return None;
                }
                total.add_scaled(&mut before.coefficients, layer.weights.row(j));
            }
            form = before;
        }
        if let Some(enclosures) = &self.enclosures {
            form = self.before_inputs(&form, enclosures)?;
        }
        let mut least = Least {
            bound: form.constant,
            strict: false,
        };
        for (c, [low, high]) in form.coefficients.iter().zip(&self.region) {
            let product = c.least_product(&low.value, &high.value);
            least.bound = least.bound.plus(&product);
            least.strict |= match c.sign() {
                Some(Ordering::Greater) => low.strict,
                Some(Ordering::Less) => high.strict,
                _ => false,
            };
        }
        least.bound = least.bound.lower();
        Some(least)
    }

    /// The form over the variables that bounds a form over the inputs from below.
    fn before_inputs(&self, form: &Form<N>, enclosures: &[AffineEnclosure]) -> Option<Form<N>> {
        let mut before = Form::zero(self.region.len());
        before.constant = form.constant.clone();
        for (input, c) in enclosures.iter().zip(&form.coefficients) {
            if !c.is_known() {
                return None;
            }
            c.add_scaled(&mut before.coefficients, &input.slopes);
            let radius = N::of(input.radius);
            let middle = c.times(&N::of(input.constant));
            let off = c.least_product(&radius.negated(), &radius);
            before.constant = before.constant.plus(&middle).plus(&off);
        }
        Some(before)
    }
}

impl<N: Number> Range<N> {
    /// Whether a ReLU is certainly on.
    fn is_on(&self) -> bool {
        let sign = self.lower.as_ref().and_then(N::sign);
        matches!(sign, Some(Ordering::Greater | Ordering::Equal))
    }

    /// Whether a ReLU is certainly off.
    fn is_off(&self) -> bool {
        let sign = self.upper.as_ref().and_then(N::sign);
        matches!(sign, Some(Ordering::Less | Ordering::Equal))
    }
}

fn lesser<N: Number>(a: &N, b: &N) -> N {
    a.negated().greater(&b.negated()).negated()
}

fn better<N: Number>(old: Option<&N>, new: Option<N>, pick: impl Fn(&N, &N) -> N) -> Option<N> {
    match (old, new) {
        (Some(old), Some(new)) => Some(pick(old, &new)),
        (old, new) => new.or_else(|| old.cloned()),
    }
}

/// For c·f(z) with z in the range: (factor, offset) with factor·z + offset ≤ c·f(z).
fn line<N: Number>(
    activation: Activation,
    range: &Range<N>,
    c: &N,
    slope: Option<f64>,
    unit: &N,
) -> Option<(N, N)> {
    let zero = || (N::zero(), N::zero());
    match activation {
        Activation::Identity => return Some((c.clone(), N::zero())),
        Activation::Relu if range.is_off() => return Some(zero()),
        Activation::Relu if range.is_on() => return Some((c.clone(), N::zero())),
        _ => {}
    }
    let sign = c.sign();
    if sign == Some(Ordering::Equal) {
        return Some(zero());
    }
    let Range { lower, upper } = range;
    if activation != Activation::Relu {
        let (l, u) = (lower.as_ref()?, upper.as_ref()?);
        let (factor, offset) = N::curve(activation, l, u, c)?;
        return Some((factor, offset.times(unit)));
    }
    match sign {
        Some(Ordering::Greater) => {
            let usual = match (lower, upper) {
                (Some(l), Some(u)) => l.plus(u).sign() == Some(Ordering::Greater),
                _ => false,
            };
            let slope = slope.unwrap_or(if usual { 1.0 } else { 0.0 });
            Some((c.times(&N::of(slope)), N::zero()))
        }
        Some(_) => {
            // The chord from (l, 0) to (u, u), raised until it clears both ends.
            let (l, u) = (lower.as_ref()?, upper.as_ref()?);
            let chord = N::of(u.share(&u.plus(&l.negated()).lower()));
            let at_lower = chord.times(l).negated();
            let at_upper = u.plus(&chord.times(u).negated());
            // Of two upper bounds the greater holds for both.
            let clears = at_lower
                .negated()
                .lower()
                .negated()
                .greater(&at_upper.negated().lower().negated());
            Some((c.times(&chord), c.times(&clears)))
        }
        // c·f(z) for f(z) from 0 to u.
        None => Some((
            N::zero(),
            c.least_product(&N::zero(), upper.as_ref()?).lower(),
        )),
    }
}
