"""Commands of evolvent-post, one file each; `app` lists them."""
