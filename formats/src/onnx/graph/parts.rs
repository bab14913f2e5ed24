//! Operators that take parts of a tensor.

use super::arguments::{Arguments, axis};
use super::{Constant, Operation, Recorder, Value};
use crate::onnx::shape::Shape;
use crate::onnx::tensor::Values;

/// The elements along an axis at these places, in this order.
fn taken(
    arguments: &Arguments<'_>,
    recorder: &mut Recorder,
    value: &Value,
    along: usize,
    places: &[usize],
    drop_axis: bool,
) -> Result<Value, String> {
    let dims = value.shape().dims();
    let inner: usize = dims[along + 1..].iter().product();
    let outer: usize = dims[..along].iter().product();
    let mut new = dims.to_vec();
    new[along] = places.len();
    let size = Shape::new(new.clone())
        .ok_or("gives too many elements")?
        .size();
    if drop_axis {
        new.remove(along);
    }
    let shape = Shape::new(new).ok_or("gives too many elements")?;
    recorder.charge(size)?;
    let rows = (0..outer).flat_map(|o| places.iter().map(move |p| o * dims[along] + p));
    let pick: Vec<usize> = rows
        .flat_map(|row| row * inner..(row + 1) * inner)
        .collect();
    match value {
        Value::Variable(x) => recorder
            .push(arguments, vec![x.index], Operation::Move(pick), shape)
            .map(Value::Variable),
        Value::Constant(constant) => {
            let values = match &constant.values {
                Values::Real(all) => Values::Real(pick.iter().map(|&i| all[i]).collect()),
                Values::Integer(all) => Values::Integer(pick.iter().map(|&i| all[i]).collect()),
            };
            Ok(Value::Constant(Constant { shape, values }))
        }
    }
}

/// A place along an axis of so many, counted from the end where negative, cut to the range.
fn place(at: i64, count: usize) -> usize {
    let count = count as i64;
    let at = if at < 0 { at.saturating_add(count) } else { at };
    at.clamp(0, count) as usize
}

/// Slice: its ranges are attributes up to operator set 9, inputs afterwards.
pub(super) fn slice(arguments: &Arguments<'_>, recorder: &mut Recorder) -> Result<Value, String> {
    let given = |name: &str, index: usize| match arguments.attribute(name) {
        Some(attribute) => Ok(Some(attribute.ints.clone())),
        None if arguments.given(index) => arguments.integers(index).map(|all| Some(all.to_vec())),
        None => Ok(None),
    };
    let starts = given("starts", 1)?.ok_or("has no starts")?;
    let ends = given("ends", 2)?.ok_or("has no ends")?;
    let axes = given("axes", 3)?.unwrap_or_else(|| (0..starts.len() as i64).collect());
    let steps = given("steps", 4)?.unwrap_or_else(|| vec![1; starts.len()]);
    if [ends.len(), axes.len(), steps.len()] != [starts.len(); 3] {
        return Err("has ranges that do not fit".to_owned());
    }
    let mut value = arguments.value(0)?.clone();
    for (i, &step) in steps.iter().enumerate() {
        let dims = value.shape().dims();
        let along = axis(axes[i], dims.len(), dims.len().saturating_sub(1))?;
        let count = dims[along];
        let step = usize::try_from(step).ok().filter(|&step| step > 0);
        let step = step.ok_or("with a step below 1 is not supported")?;
        let range = place(starts[i], count)..place(ends[i], count);
        let places: Vec<usize> = range.step_by(step).collect();
        if places.is_empty() {
            return Err("gives nothing".to_owned());
        }
        value = taken(arguments, recorder, &value, along, &places, false)?;
    }
    Ok(value)
}

/// Split into equal parts, or into parts of given sizes.
pub(super) fn split(
    arguments: &Arguments<'_>,
    recorder: &mut Recorder,
) -> Result<Vec<Value>, String> {
    let value = arguments.value(0)?;
    let dims = value.shape().dims();
    let along = arguments.axis(0, dims.len(), dims.len().saturating_sub(1))?;
    let (count, parts) = (dims[along], arguments.node.output.len());
    let sizes = match arguments.attribute("split") {
        Some(attribute) => attribute.ints.clone(),
        None if arguments.given(1) => arguments.integers(1)?.to_vec(),
        // The last part may be smaller.
        None => {
            let most = count.div_ceil(parts);
            let size = |i: usize| count.saturating_sub(i * most).min(most) as i64;
            (0..parts).map(size).collect()
        }
    };
    let sizes = sizes.iter().map(|&n| usize::try_from(n).ok());
    let sizes = sizes.collect::<Option<Vec<_>>>().unwrap_or_default();
    let fits = sizes.len() == parts
        && sizes.iter().try_fold(0_usize, |a, &b| a.checked_add(b)) == Some(count);
    if !fits {
        return Err(format!(
            "sizes {sizes:?} do not fit {count} in {parts} parts"
        ));
    }
    let mut first = 0;
    let mut all = Vec::with_capacity(parts);
    for size in sizes {
        let places: Vec<usize> = (first..first + size).collect();
        all.push(taken(arguments, recorder, value, along, &places, false)?);
        first += size;
    }
    Ok(all)
}

/// Gather with constant indices, a list or a single one.
pub(super) fn gather(arguments: &Arguments<'_>, recorder: &mut Recorder) -> Result<Value, String> {
    let value = arguments.value(0)?;
    let dims = value.shape().dims();
    let along = arguments.axis(0, dims.len(), dims.len().saturating_sub(1))?;
    let indices = arguments.integers(1)?;
    let rank = arguments.value(1)?.shape().dims().len();
    if rank > 1 {
        return Err("with indices of more than one dimension is not supported".to_owned());
    }
    let count = dims.get(along).copied().unwrap_or(0) as i64;
    let places = indices.iter().map(|&i| {
        let place = if i < 0 { i + count } else { i };
        usize::try_from(place).ok().filter(|_| place < count)
    });
    let places = places.collect::<Option<Vec<_>>>();
    let places = places.ok_or_else(|| format!("indices {indices:?} do not fit"))?;
    taken(arguments, recorder, value, along, &places, rank == 0)
}
