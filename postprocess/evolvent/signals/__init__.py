"""Lines of signals: spectra over frequency and order, order maps, sidebands, crossings.

Procedures over arrays; what a history holds is read in `selection`, `turning` and `sampling`.
"""
