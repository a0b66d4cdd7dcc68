/** Versions of the programs that produced a result. */
#pragma once

/** All versions, as a new string. */
char *result_versions(void);
