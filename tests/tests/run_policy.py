"""Runs a policy in onnxruntime: MODEL, features (f32, little-endian), where to write the accelerations."""

import sys

import numpy
import onnxruntime

model, features, accelerations = sys.argv[1:]
session = onnxruntime.InferenceSession(model, providers=["CPUExecutionProvider"])
(told,) = session.get_inputs()
rows = numpy.fromfile(features, "<f4").reshape(-1, told.shape[1])
(given,) = session.run(None, {told.name: rows})
given.astype("<f4").tofile(accelerations)
