"""Windows by name: all that their options need to know."""

RECTANGULAR, HANN = "rectangular", "hann"
# By the names of scipy.signal.
WINDOWS = {
    RECTANGULAR: "boxcar",
    HANN: "hann",
    "hamming": "hamming",
    "blackman": "blackman",
    "blackmanharris": "blackmanharris",
    "flattop": "flattop",
}
