#include "base/memory.h"
#include "base/status.h"
#include "commands/cli.h"
#include "commands/help.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Minimum memory of a command, in bytes: the tables of the kernel, which are created before anything can be refused. */
enum { NEEDED = 8 * 1024 * 1024 };

int main(int argc, char **argv)
{
    memory_need(NEEDED);
    evl_error error = {.code = EVL_EXIT_OK};
    errno = 0;
    evl_exit code = cli_run(&program_command, argc, argv, &error);
    if (fflush(stdout) != 0 || ferror(stdout) != 0) { /* a full disk, or a closed pipe */
        code = EVL_EXIT_IO;
        if (error.code == EVL_EXIT_OK) {
            evl_error_set(&error, code, "", "cannot write to standard output%s%s", errno != 0 ? ": " : "",
                          errno != 0 ? strerror(errno) : "");
        }
    }
    if (error.code != EVL_EXIT_OK) {
        evl_error_print(stderr, &error);
    }
    if (code == EVL_EXIT_IO) {
        _exit(code); /* skip exit handlers: a library could not write its data anyway */
    }
    return code;
}
