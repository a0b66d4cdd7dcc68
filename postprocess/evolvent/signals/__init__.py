"""Signal analysis: spectra over frequency and order, order maps, sidebands, crossings.

Procedures operate on arrays; `selection`, `turning` and `sampling` read them from a history.
"""
