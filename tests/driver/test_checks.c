/* Check sums and hashes against published values, and checksums of files. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include <fcntl.h>
#include <unistd.h>

#include "base/crc32.h"
#include "base/sha256.h"
#include "files/checksum.h"

static void the_crc_is_that_of_the_catalogue_wherever_a_text_is_parted(void **state)
{
    (void)state;
    static const char digits[] = "123456789"; /* "check" of CRC-32/ISO-HDLC in the catalogue of parametrised CRCs */
    static const char dog[] = "The quick brown fox jumps over the lazy dog"; /* as often quoted */
    assert_int_equal(crc32_on(0, "", 0), 0);
    assert_int_equal(crc32_on(0, digits, strlen(digits)), 0xcbf43926U);
    for (size_t cut = 0; cut <= strlen(dog); cut++) {
        assert_int_equal(crc32_on(crc32_on(0, dog, cut), dog + cut, strlen(dog) - cut), 0x414fa339U);
    }
}

static void assert_sha256(const char *text, size_t times, size_t piece, const char *expected)
{
    sha256 hash;
    char found[SHA256_TEXT];
    sha256_start(&hash);
    for (size_t i = 0; i < times; i++) {
        for (size_t k = 0; k < strlen(text); k += piece) {
            const size_t rest = strlen(text) - k;
            sha256_add(&hash, text + k, rest < piece ? rest : piece);
        }
    }
    sha256_finish(&hash, found);
    assert_string_equal(found, expected);
}

static void the_sha_is_that_of_the_examples_of_its_standard_wherever_a_text_is_parted(void **state)
{
    (void)state;
    static const char two_blocks[] = "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq";
    assert_sha256("", 1, 1, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    for (size_t piece = 1; piece < 60; piece++) {
        assert_sha256("abc", 1, piece, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        assert_sha256(two_blocks, 1, piece, "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    }
    assert_sha256("aaaaaaaaaa", 100000, 7, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

/* ---- checksums ---- */

static const char path[] = "test_checks.tmp";

static void write_file(const char *bytes, size_t n)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, n, file), n);
    assert_int_equal(fclose(file), 0);
}

static size_t read_file(char *bytes, size_t room)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    const size_t n = fread(bytes, 1, room, file);
    assert_int_equal(fclose(file), 0);
    return n;
}

static void append_to_file(void)
{
    const int descriptor = open(path, O_RDWR);
    assert_true(descriptor >= 0);
    assert_true(checksum_append(descriptor));
    assert_int_equal(close(descriptor), 0);
}

static const char checksum_of_digits[] = "evolvent-seal 1 crc32 cbf43926 of 9 bytes";

static void a_seal_is_a_line_that_another_program_can_check(void **state)
{
    (void)state;
    char text[200] = "", expected[200];
    write_file("123456789", 9);
    append_to_file();
    assert_int_equal(read_file(text, sizeof text - 1), 9 + 64);
    (void)snprintf(expected, sizeof expected, "123456789%-63s\n", checksum_of_digits);
    assert_string_equal(text, expected);
    assert_int_equal(checksum_verify(path), CHECKSUM_CORRECT);
}

static void a_seal_holds_at_the_front_too(void **state)
{
    (void)state;
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fprintf(file, "%-63s\n123456789", checksum_of_digits) > 0);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(checksum_verify(path), CHECKSUM_CORRECT);
}

static void a_seal_of_the_first_bytes_does_not_care_for_what_follows(void **state)
{
    (void)state;
    char bytes[256];
    write_file("123456789-and-more", 18);
    const int descriptor = open(path, O_RDWR);
    assert_true(checksum_append_of_first(descriptor, 9));
    const size_t n = read_file(bytes, sizeof bytes);
    assert_int_equal(n, 18 + 64);
    bytes[n] = '\0';
    assert_non_null(strstr(bytes, "evolvent-seal 1 crc32 cbf43926 of the first 9 bytes  "));
    for (off_t i = 0; i < 18; i++) {
        const char other = (char)(bytes[i] ^ 1);
        assert_int_equal(pwrite(descriptor, &other, 1, i), 1);
        assert_int_equal(checksum_verify(path), i < 9 ? CHECKSUM_WRONG : CHECKSUM_CORRECT);
        assert_int_equal(pwrite(descriptor, &bytes[i], 1, i), 1);
    }
    const char longer = '8';
    const off_t digit = 18 + (off_t)strlen("evolvent-seal 1 crc32 cbf43926 of the first ");
    assert_int_equal(pwrite(descriptor, &longer, 1, digit), 1);
    assert_int_equal(checksum_verify(path), CHECKSUM_WRONG);
    /* of more bytes than there are, or of less than none: a word that does not hold, not a file that cannot be read */
    static const char *const lies[] = {"99 ", "-9 "};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(pwrite(descriptor, lies[i], 3, digit), 3);
        assert_int_equal(checksum_verify(path), CHECKSUM_WRONG);
    }
    assert_int_equal(close(descriptor), 0);
}

static void every_flip_and_cut_breaks_the_seal_or_leaves_none(void **state)
{
    (void)state;
    char bytes[200];
    write_file("what is in it", 13);
    assert_int_equal(checksum_verify(path), CHECKSUM_NONE);
    append_to_file();
    const size_t n = read_file(bytes, sizeof bytes), mark = 13 + strlen("evolvent-seal 1 crc32 ");
    for (size_t i = 0; i < n; i++) {
        for (int bit = 0; bit < 8; bit++) {
            bytes[i] = (char)(bytes[i] ^ (1 << bit));
            write_file(bytes, n);
            bytes[i] = (char)(bytes[i] ^ (1 << bit));
            assert_int_equal(checksum_verify(path), i < 13 || i >= mark ? CHECKSUM_WRONG : CHECKSUM_NONE);
        }
        write_file(bytes, i);
        assert_int_equal(checksum_verify(path), CHECKSUM_NONE);
    }
}

static void what_is_not_there_cannot_be_read(void **state)
{
    (void)state;
    assert_int_equal(checksum_verify("no/such/file"), CHECKSUM_UNREADABLE);
    assert_int_equal(checksum_verify("."), CHECKSUM_UNREADABLE);
}

static int remove_file(void **state)
{
    (void)state;
    return unlink(path) == 0 || access(path, F_OK) != 0 ? 0 : -1;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_crc_is_that_of_the_catalogue_wherever_a_text_is_parted),
        cmocka_unit_test(the_sha_is_that_of_the_examples_of_its_standard_wherever_a_text_is_parted),
        cmocka_unit_test_teardown(a_seal_is_a_line_that_another_program_can_check, remove_file),
        cmocka_unit_test_teardown(a_seal_holds_at_the_front_too, remove_file),
        cmocka_unit_test_teardown(a_seal_of_the_first_bytes_does_not_care_for_what_follows, remove_file),
        cmocka_unit_test_teardown(every_flip_and_cut_breaks_the_seal_or_leaves_none, remove_file),
        cmocka_unit_test(what_is_not_there_cannot_be_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
