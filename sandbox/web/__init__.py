"""The sandbox as web pages: kernels compiled to WebAssembly, and a page that draws what they say."""
