/** What made a result. */
#pragma once

/** Versions of all that made it, as a new string. */
char *result_versions(void);
