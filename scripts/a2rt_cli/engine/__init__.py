"""Runs the C++ programs: a2rt-render, the Vulkan layer, a2rt-core. Nothing else starts them."""
