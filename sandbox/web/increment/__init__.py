"""A load increment as kernels: what ``core.quasistatic`` does, bit for bit, where no Python runs.

Made of core's own kernels, called in core's order; what is Python and NumPy there is a kernel here. The same source runs on the
desk and in a browser. Nothing here knows the rest of ``sandbox``.
"""
