"""Commands of evolvent-sweep, one file each; `app` lists them."""
