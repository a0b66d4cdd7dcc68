"""Names of window functions, separate so that options need no other import."""

RECTANGULAR, HANN = "rectangular", "hann"
# Values are names in scipy.signal.
WINDOWS = {
    RECTANGULAR: "boxcar",
    HANN: "hann",
    "hamming": "hamming",
    "blackman": "blackman",
    "blackmanharris": "blackmanharris",
    "flattop": "flattop",
}
