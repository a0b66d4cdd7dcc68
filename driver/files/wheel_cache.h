/** What was computed of wheels with compliance, kept for the user's next runs: a file a wheel in the user's cache folder.
 *
 *  The folder is $EVOLVENT_CACHE, else $XDG_CACHE_HOME/evolvent, else $HOME/.cache/evolvent; EVOLVENT_CACHE=off: none. What cannot
 *  be written or read is computed. Many processes may use it at once. It holds 64 MB at most; the files used longest ago go first.
 *  A file counts for the program whose sources computed it, so results have the bits of a run without cache. */
#pragma once

#include <evolvent/description.h>

typedef struct wheel_cache wheel_cache;

wheel_cache *wheel_cache_open(void);
void wheel_cache_close(wheel_cache **cache);
/** For model_create. */
const evl_wheel_store *wheel_cache_store(const wheel_cache *cache);
