"""A load increment as kernels: what ``core.quasistatic`` does, bit for bit, where no Python runs.

Made of core's own kernels, and of what core shares (``core.jit.shared``): Python on the desk, compiled here. What moves bodies
and tries again is Python there and a kernel here. Nothing here knows the rest of ``sandbox``.
"""
