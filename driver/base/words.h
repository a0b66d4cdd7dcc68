/** Lists of words: separated by blanks in tables and attributes, by commas in messages. A leaf. */
#pragma once

#include <stdbool.h>

/** Whether `word` is one of the blank-separated words. */
bool words_contain(const char *words, const char *word);
/** Place of a word among others; -1 if it is none of them. */
int words_index(const char *word, int n, const char *const *words);
/** The words as strings, in one piece of memory that is the array. @return their number */
int words_split(const char *words, char ***list);
/** The length of a text, if it is more than the width: of a column. */
int words_width(int width, const char *text);
/** The words with the separator between them, as a new string. */
char *words_join(int n, const char *const *words, const char *separator);
/** Bytes of the start of a text that is to be shown: at most so many, and no part of a UTF-8 character. */
int words_cut(const char *text, int most);
/** A word as a shell takes it: in quotes if it needs some, as a new string. */
char *words_quoted(const char *word);
