#include "base/words.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

bool words_contain(const char *words, const char *word)
{
    const size_t length = strlen(word);
    for (const char *start = words; *start != '\0' && length > 0;) {
        const size_t n = strcspn(start, " ");
        if (n == length && strncmp(start, word, n) == 0) {
            return true;
        }
        start += n + strspn(start + n, " ");
    }
    return false;
}

int words_index(const char *word, int n, const char *const *words)
{
    int i = 0;
    while (i < n && strcmp(words[i], word) != 0) {
        i++;
    }
    return i < n ? i : -1;
}

int words_split(const char *words, char ***list)
{
    const size_t size = strlen(words) + 1, most = size / 2 + 1;
    char **items = xcalloc(most * sizeof *items + size, 1);
    char *copy = memcpy(items + most, words, size);
    int n = 0;
    for (char *start = copy; *start != '\0';) {
        items[n++] = start;
        start += strcspn(start, " ");
        if (*start == ' ') {
            *start++ = '\0';
        }
    }
    *list = items;
    return n;
}

int words_width(int width, const char *text)
{
    const int length = (int)strlen(text);
    return length > width ? length : width;
}

char *words_join(int n, const char *const *words, const char *separator)
{
    char *joined = xstrdup("");
    for (int i = 0; i < n; i++) {
        CLEANUP_FREE char *shorter = joined;
        joined = xasprintf("%s%s%s", shorter, i == 0 ? "" : separator, words[i]);
    }
    return joined;
}

int words_cut(const char *text, int most)
{
    int shown = (int)strnlen(text, (size_t)most);
    while (shown > 0 && ((unsigned char)text[shown] & 0xC0) == 0x80) {
        shown--;
    }
    return shown;
}

char *words_quoted(const char *word)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=:,+@%",
                      quote[] = "'\\''";
    if (word[0] != '\0' && strspn(word, plain) == strlen(word)) {
        return xstrdup(word);
    }
    char *quoted = xcalloc((sizeof quote - 1) * strlen(word) + 3, 1), *to = quoted;
    *to++ = '\'';
    for (; *word != '\0'; word++) {
        const size_t n = *word == '\'' ? sizeof quote - 1 : 1;
        memcpy(to, n > 1 ? quote : word, n);
        to += n;
    }
    *to = '\'';
    return quoted;
}
