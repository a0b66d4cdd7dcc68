"""The commands of evolvent-sweep, a file each; `app` lists them."""
