"""Permitted reasons for the rejection of a random pair of gears."""

# Its teeth, its hub, the fit of the wheels, and loads beyond the range of teeth and tip edges.
OF_A_PAIR = (
    *("the teeth are undercut", "the tooth is pointed", "thick at the tip, less than 0.1 modules"),
    *(
        "undercut leaves it a contact ratio",
        "undercut shortens the path of contact, and the corner",
    ),
    *("the involute is only", "too close to the root circle"),
    *("tip interference: ", "runs into the root circle", "leaves the line of action"),
    *("no centre distance gives this backlash", "only tip edges are in contact"),
    *("does not start on the active profile", "no tooth pair is on its path of contact"),
    *("touches the fillet of the", "with a tip edge 0.4 pitches off its path of contact"),
    "past both ends of its path of contact",
)
