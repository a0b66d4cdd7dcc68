"""The commands of evolvent-post, a file each; `app` lists them."""
