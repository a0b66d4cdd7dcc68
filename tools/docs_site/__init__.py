"""The documentation as one site: pages, and references made from the code: tools/build-docs."""
