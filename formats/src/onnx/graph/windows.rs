//! Operators that move a window over images: convolution and pooling.

use super::arguments::Arguments;
use super::{Constant, Operation, Recorder, Value, Variable};
use crate::onnx::shape::{MOST_WEIGHTS, Shape};
use crate::onnx::tensor::Values;

/// Where a window goes over an image of one or more dimensions.
struct Windows {
    /// The shape of the positions.
    out: Vec<usize>,
    /// For each position, the elements of one channel under each tap of the kernel; `None` beyond
    /// the image's edge.
    taps: Vec<Vec<Option<usize>>>,
}

impl Windows {
    fn new(
        arguments: &Arguments<'_>,
        image: &[usize],
        kernel: &[usize],
        channels: usize,
    ) -> Result<Self, String> {
        let rank = image.len();
        let numbers = |name: &str, otherwise: usize, count: usize| -> Result<Vec<usize>, String> {
            let Some(attribute) = arguments.attribute(name) else {
                return Ok(vec![otherwise; count]);
            };
            let all = attribute.ints.iter().map(|&n| usize::try_from(n).ok());
            all.collect::<Option<Vec<_>>>()
                .filter(|all| all.len() == count && all.iter().all(|&n| n <= MOST_WEIGHTS))
                .ok_or_else(|| format!("{name} {:?} is not supported", attribute.ints))
        };
        let strides = numbers("strides", 1, rank)?;
        let dilations = numbers("dilations", 1, rank)?;
        let pads = numbers("pads", 0, 2 * rank)?;
        let padding = arguments.text("auto_pad");
        if !matches!(padding, "" | "NOTSET" | "VALID") || arguments.integer("ceil_mode", 0) != 0 {
            return Err(
                "with auto_pad other than NOTSET and VALID, or ceil_mode, is not supported"
                    .to_owned(),
            );
        }
        let side = |axis: usize| {
            let whole = image[axis] + pads[axis] + pads[axis + rank];
            let reach = dilations[axis].checked_mul(kernel[axis].checked_sub(1)?)?;
            Some(whole.checked_sub(reach + 1)?.checked_div(strides[axis])? + 1)
        };
        let out = (0..rank).map(side).collect::<Option<Vec<_>>>();
        let out = out.ok_or("has a window that does not fit the image")?;
        let positions = Shape::new(out.clone()).map(|shape| shape.size());
        let size: usize = kernel.iter().product();
        let taps = positions.and_then(|n| n.checked_mul(size)?.checked_mul(channels));
        if taps.is_none_or(|taps| taps > MOST_WEIGHTS) {
            return Err(format!("has more than {MOST_WEIGHTS} (2²⁶) weights"));
        }
        let tap = |position: usize, tap: usize| {
            let (at, within) = (unflat(position, &out), unflat(tap, kernel));
            (0..rank).try_fold(0, |flat, axis| {
                let place = at[axis] * strides[axis] + within[axis] * dilations[axis];
                let place = place.checked_sub(pads[axis])?;
                (place < image[axis]).then_some(flat * image[axis] + place)
            })
        };
        let all = 0..positions.unwrap_or(0);
        let taps = all
            .map(|p| (0..size).map(|t| tap(p, t)).collect())
            .collect();
        Ok(Self { out, taps })
    }
}

/// The indices of a flat index.
fn unflat(mut flat: usize, dims: &[usize]) -> Vec<usize> {
    let mut indices = vec![0; dims.len()];
    for (index, &d) in indices.iter_mut().zip(dims).rev() {
        *index = flat % d;
        flat /= d;
    }
    indices
}

/// The channels and the image of a value of one example.
fn image(x: &Variable) -> Result<(usize, &[usize]), String> {
    match x.shape.dims() {
        [1, channels, image @ ..] if !image.is_empty() => Ok((*channels, image)),
        dims => Err(format!("of shape {dims:?} is not supported")),
    }
}

fn push(
    arguments: &Arguments<'_>,
    recorder: &mut Recorder,
    x: usize,
    operation: Operation,
    channels: usize,
    out: &[usize],
) -> Result<Value, String> {
    let shape = Shape::new([&[1, channels], out].concat()).ok_or("gives too many elements")?;
    recorder
        .push(arguments, vec![x], operation, shape)
        .map(Value::Variable)
}

pub(super) fn convolution(
    arguments: &Arguments<'_>,
    recorder: &mut Recorder,
) -> Result<Value, String> {
    let x = arguments.variable(0)?;
    let (channels, image) = image(x)?;
    let Value::Constant(Constant {
        shape,
        values: Values::Real(kernel),
    }) = arguments.value(1)?
    else {
        return Err("with a kernel that is no real constant is not supported".to_owned());
    };
    let [filters, depth, sides @ ..] = shape.dims() else {
        return Err(format!(
            "with a kernel of shape {:?} is not supported",
            shape.dims()
        ));
    };
    let (filters, depth) = (*filters, *depth);
    let groups = usize::try_from(arguments.integer("group", 1)).unwrap_or(0);
    let fits = groups > 0
        && sides.len() == image.len()
        && depth.checked_mul(groups) == Some(channels)
        && filters.is_multiple_of(groups);
    if !fits {
        let (x, w) = (x.shape.dims(), shape.dims());
        return Err(format!(
            "shapes {x:?} and {w:?} in {groups} groups do not fit"
        ));
    }
    let bias = match arguments.given(2).then(|| arguments.value(2)).transpose()? {
        None => vec![0.0; filters],
        Some(Value::Constant(Constant {
            values: Values::Real(bias),
            ..
        })) if bias.len() == filters => bias.clone(),
        Some(_) => return Err("its third input must be a real constant for each filter".to_owned()),
    };
    let windows = Windows::new(arguments, image, sides, filters.saturating_mul(depth))?;
    let (size, pixels) = (
        sides.iter().product::<usize>(),
        image.iter().product::<usize>(),
    );
    let mut maps = Vec::new();
    for filter in 0..filters {
        let first = filter / (filters / groups) * depth;
        for taps in &windows.taps {
            let under = |d: usize| {
                let weights = &kernel[(filter * depth + d) * size..][..size];
                let under = taps.iter().zip(weights);
                under.filter_map(move |(tap, &w)| tap.map(|tap| ((first + d) * pixels + tap, w)))
            };
            maps.push(
                (0..depth)
                    .flat_map(under)
                    .filter(|(_, w)| *w != 0.0)
                    .collect(),
            );
        }
    }
    recorder.charge_constant(maps.iter().map(Vec::len).sum())?;
    let map = push(
        arguments,
        recorder,
        x.index,
        Operation::Map(maps),
        filters,
        &windows.out,
    )?;
    let (Value::Variable(value), positions) = (&map, windows.taps.len()) else {
        return Ok(map);
    };
    let constant = bias.iter().flat_map(|&b| std::iter::repeat_n(b, positions));
    let operation = Operation::Add {
        own: 1.0,
        other: 1.0,
        constant: constant.collect(),
    };
    push(
        arguments,
        recorder,
        value.index,
        operation,
        filters,
        &windows.out,
    )
}

/// The kernel's sides of a pooling operator.
fn kernel(arguments: &Arguments<'_>, rank: usize) -> Result<Vec<usize>, String> {
    let attribute = arguments
        .attribute("kernel_shape")
        .ok_or("has no kernel_shape")?;
    let sides = attribute
        .ints
        .iter()
        .map(|&n| usize::try_from(n).ok().filter(|&n| n > 0));
    sides
        .collect::<Option<Vec<_>>>()
        .filter(|sides| sides.len() == rank)
        .ok_or_else(|| format!("kernel_shape {:?} does not fit", attribute.ints))
}

/// For each output of a pooling operator, the elements of x under the window and the window's size.
type Pools = (Vec<(Vec<usize>, usize)>, Vec<usize>);

fn pools(arguments: &Arguments<'_>, x: &Variable, sides: &[usize]) -> Result<Pools, String> {
    let (channels, image) = image(x)?;
    let windows = Windows::new(arguments, image, sides, channels)?;
    let pixels: usize = image.iter().product();
    let mut all = Vec::new();
    for channel in 0..channels {
        for taps in &windows.taps {
            let under: Vec<usize> = taps
                .iter()
                .flatten()
                .map(|t| channel * pixels + t)
                .collect();
            if under.is_empty() {
                return Err("has a window with nothing under it".to_owned());
            }
            all.push((under, taps.len()));
        }
    }
    Ok((all, windows.out))
}

pub(super) fn max_pool(
    arguments: &Arguments<'_>,
    recorder: &mut Recorder,
) -> Result<Value, String> {
    let x = arguments.variable(0)?;
    let (channels, image) = image(x)?;
    let (pools, out) = pools(arguments, x, &kernel(arguments, image.len())?)?;
    let largest = Operation::Largest(pools.into_iter().map(|(under, _)| under).collect());
    push(arguments, recorder, x.index, largest, channels, &out)
}

/// AveragePool, and GlobalAveragePool: the sum, divided.
pub(super) fn average_pool(
    arguments: &Arguments<'_>,
    recorder: &mut Recorder,
    global: bool,
) -> Result<Value, String> {
    let x = arguments.variable(0)?;
    let (channels, image) = image(x)?;
    let sides = if global {
        image.to_vec()
    } else {
        kernel(arguments, image.len())?
    };
    let (pools, out) = pools(arguments, x, &sides)?;
    let padded = arguments.integer("count_include_pad", 0) != 0;
    let count =
        |(under, size): &(Vec<usize>, usize)| if padded { *size } else { under.len() } as f64;
    let divisors = pools.iter().map(count).collect();
    let ones = |(under, _): (Vec<usize>, usize)| under.into_iter().map(|i| (i, 1.0)).collect();
    let sums = Operation::Map(pools.into_iter().map(ones).collect());
    let sum = push(arguments, recorder, x.index, sums, channels, &out)?;
    let Value::Variable(value) = &sum else {
        return Ok(sum);
    };
    push(
        arguments,
        recorder,
        value.index,
        Operation::Divide(divisors),
        channels,
        &out,
    )
}

/// BatchNormalization as it is applied: (x − mean) / √(variance + ε) · scale + shift, by channel.
pub(super) fn normalisation(
    arguments: &Arguments<'_>,
    recorder: &mut Recorder,
) -> Result<Value, String> {
    let x = arguments.variable(0)?;
    let dims = x.shape.dims();
    let channels = *dims
        .get(1)
        .ok_or("of a value without channels is not supported")?;
    let of = |index: usize| match arguments.value(index)? {
        Value::Constant(Constant {
            values: Values::Real(values),
            ..
        }) if values.len() == channels => Ok(values.clone()),
        _ => Err(format!(
            "input {index} must be a real constant for each channel"
        )),
    };
    let (scale, shift, mean, variance) = (of(1)?, of(2)?, of(3)?, of(4)?);
    let epsilon = arguments.attribute("epsilon").map_or(1e-5_f32, |a| a.f);
    let deviations: Vec<f64> = variance
        .iter()
        .map(|v| (v + f64::from(epsilon)).sqrt())
        .collect();
    if deviations.iter().any(|d| !(d.is_normal() && *d > 0.0)) {
        return Err("has a variance that is not positive".to_owned());
    }
    let behind: usize = dims[2..].iter().product();
    let spread = |values: &[f64]| -> Vec<f64> {
        let example = values.iter().flat_map(|&v| std::iter::repeat_n(v, behind));
        let example: Vec<f64> = example.collect();
        (0..dims[0]).flat_map(|_| example.iter().copied()).collect()
    };
    let add = |constant: Vec<f64>, other| Operation::Add {
        own: 1.0,
        other,
        constant,
    };
    let steps = [
        add(spread(&mean), -1.0),
        Operation::DivideNearly(spread(&deviations)),
        Operation::Scale(spread(&scale)),
        add(spread(&shift), 1.0),
    ];
    let mut value = x.clone();
    for operation in steps {
        let shape = x.shape.clone();
        value = recorder.push(arguments, vec![value.index], operation, shape)?;
    }
    Ok(Value::Variable(value))
}
