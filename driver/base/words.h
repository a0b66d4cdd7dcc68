/** Lists of words: separated by blanks in tables and attributes, by commas in messages. Leaf module. */
#pragma once

#include <stdbool.h>

/** Whether `word` is one of the blank-separated words. */
bool words_contain(const char *words, const char *word);
/** Index of a word in an array; -1 if it is not in it. */
int words_index(const char *word, int n, const char *const *words);
/** The words as strings; one allocation holds the array and the text. @return their number */
int words_split(const char *words, char ***list);
/** The larger of `width` and the length of the text: width of a column. */
int words_width(int width, const char *text);
/** Join the words with the separator, as a new string. */
char *words_join(int n, const char *const *words, const char *separator);
/** Bytes of the start of a text to be shown: at most `most`, without splitting a UTF-8 character. */
int words_cut(const char *text, int most);
/** A word quoted for a shell where necessary, as a new string. */
char *words_quoted(const char *word);
