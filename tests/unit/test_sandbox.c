/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gifts of the sandbox of a case, which neither shows addresses nor
 * takes long. */
#include "../../src/case/library.h"
#include "../../src/case/sandbox.h"

#include <check.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

Suite *sandbox_suite(void);

/* Return the outcome of a piece of code: the text it returns, or a message. */
static const char *outcome(const char *code) {
  static char text[2048];
  struct sandbox *sandbox = sandbox_new("x.lua", library_open);
  const char *error = sandbox_run(sandbox, code);
  const char *value = error;
  if (value == NULL) value = lua_tostring(sandbox_state(sandbox), -1);
  snprintf(text, sizeof text, "%s", value != NULL ? value : "no text");
  sandbox_destroy(sandbox);
  return text;
}

/* Answers of Lua 5.4 */
static const struct {
  const char *code, *text;
} PATTERNS[] = {
    {"('key = value'):find('(%w+)%s*=%s*(%w+)')", "1 11 key value"},
    {"('key = value'):find('=', 1, true)", "5 5"},
    {"('a.b'):find('.', -1)", "3 3"},
    {"('abc'):find('b', 9)", "nil"},
    {"('  x '):match('^%s*(.-)%s*$')", "x"},
    {"('f(a(b)c)d'):match('%b()')", "(a(b)c)"},
    {"('THE (quick) fox'):find('%f[%a]%a+%f[%A]', 5)", "6 10"},
    {"('say \"hi\"'):match('([\"\\']).-%1')", "\""},
    {"('hello'):match('()ll()')", "3 5"},
    {"('x^2]'):match('[]^]+')", "^"},
    {"('2024-05'):match('(%d+)-?(%d*)')", "2024 05"},
    {"('abc'):gsub('%w', '%0%0')", "aabbcc 3"},
    {"('abc'):gsub('', '-')", "-a-b-c- 4"},
    {"('abc'):gsub('b', { b = 7 })", "a7c 1"},
    {"('abc'):gsub('(.)(.)', function(x, y) return y .. x end)", "bac 1"},
    {"('aaa'):gsub('a', 'b', 2)", "bba 2"},
    {"('a b'):gmatch('%a')()", "a"},
    {"('a'):find('[a')", "x.lua:1: malformed pattern (missing ']')"},
    {"('a'):find('%')", "x.lua:1: malformed pattern (ends with '%')"},
    {"('a'):gsub('a', '%2')", "x.lua:1: invalid capture index %2"},
    {"('a'):find()",
     "x.lua:1: bad argument #1 to 'find' (string expected, got no value)"},
};

START_TEST(patterns_are_those_of_lua) {
  char code[512];
  snprintf(code, sizeof code,
           "local t = { %s } if #t == 0 then t[1] = 'nil' end\n"
           "return table.concat(t, ' ')",
           PATTERNS[_i].code);
  const char *text = outcome(code);
  ck_assert_msg(
      strncmp(text, PATTERNS[_i].text, strlen(PATTERNS[_i].text)) == 0,
      "%s: %s", PATTERNS[_i].code, text);
}
END_TEST

START_TEST(gmatch_finds_all) {
  ck_assert_str_eq(outcome("local s = ''\n"
                           "for k, v in ('a=1, b=2'):gmatch('(%w)=(%w)') do\n"
                           "  s = s .. k .. v end\n"
                           "for w in (' x yz'):gmatch('%a*') do\n"
                           "  s = s .. '<' .. w .. '>' end return s"),
                   "a1b2<><x><yz>");
}
END_TEST

/* Each of these would take minutes, or years. */
static const struct {
  const char *code, *function;
} ENDLESS[] = {
    {"local x = ('a'):rep(100):find(('a-'):rep(30) .. 'b')", "find"},
    {"local x = ('a'):rep(1e5):match('.-.-.-b')", "match"},
    {"local x = ('a'):rep(100):gsub(('a*'):rep(30) .. 'b', '')", "gsub"},
    {"for w in ('a'):rep(1e5):gmatch('.-.-b') do end", ""},
    {"local x = ('a'):rep(1e8):find(('a'):rep(5e7) .. 'b', 1, true)", "find"},
    {"local x = table.move({1}, 1, 1e9, 2)", "move"},
    {"local t = {} for i = 1, 1e7 do table.insert(t, 1, i) end", "insert"},
    {"local t = {} for i = 1, 1e4 do t[i] = i end\n"
     "for i = 1, 1e8 do table.concat(t) end",
     "concat"},
    {"local t, s = {}, ('a'):rep(1e7) for i = 1, 1e5 do t[i] = s end\n"
     "table.sort(t)",
     "sort"},
    {"local x = table.sort({1, 2}, function() while true do end end)", ""},
    {"local s = ('a'):rep(1e7) for i = 1, 1e8 do utf8.len(s) end", "len"},
    {"local s = ('1'):rep(1e6) for i = 1, 1e8 do tonumber(s) end", "tonumber"},
    {"local x = ('a'):gsub('a', function() while true do end end)", ""},
};

START_TEST(c_functions_do_not_take_long) {
  char in[64] = "";
  if (*ENDLESS[_i].function != '\0')
    snprintf(in, sizeof in, "in '%s'", ENDLESS[_i].function);
  const clock_t begin = clock();
  const char *text = outcome(ENDLESS[_i].code);
  const double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
  ck_assert_msg(strstr(text, "still running after 100 million") != NULL &&
                    strstr(text, in) != NULL && strncmp(text, "x.lua:", 6) == 0,
                "%s: %s", ENDLESS[_i].code, text);
  /* 1 on the machine it was made on, where they are quick */
  ck_assert_double_le(seconds, 30);
}
END_TEST

START_TEST(nothing_is_repeated_without_end) {
  ck_assert_str_eq(outcome("return (''):rep(1e18)"), "");
}
END_TEST

/* The clock ends what instructions do not measure: texts that are compared. */
START_TEST(time_is_bounded) {
  const char *text = outcome(
      "local s, t = ('a'):rep(5e7), ('a'):rep(5e7)\n"
      "for i = 1, 1e9 do local x = s < t end");
  ck_assert_msg(
      strstr(text, "x.lua:2: the case is still running after ") != NULL, "%s",
      text);
}
END_TEST

/* Many calls are no long call. */
START_TEST(each_call_has_its_own_bounds) {
  struct sandbox *sandbox = sandbox_new("x.lua", library_open);
  lua_State *L = sandbox_state(sandbox);
  ck_assert_ptr_null(sandbox_run(
      sandbox, "return function() for i = 1, 4e5 do end return 1 end"));
  for (int k = 0; k < 300; k++) { /* 120 million instructions */
    lua_pushvalue(L, -1);
    ck_assert_ptr_null(sandbox_call(sandbox, 0, 1));
    lua_pop(L, 1);
  }
  sandbox_destroy(sandbox);
}
END_TEST

static const struct {
  const char *code, *text;
} HIDDEN[] = {
    {"return tostring({}) .. tostring(print) .. tostring(1.5) .. tostring(nil)",
     "tablefunction1.5nil"},
    {"return string.format('%5.2f %s %s %% %d', 1, {}, 'x', 3)",
     " 1.00 table x % 3"},
    {"return string.format('%p|%-9p|%%p\\0%s', {}, print, {})",
     "table|function |%p"},
    {"return (string.format('\\0%s', {}):gsub('%z', ''))", "table"},
    {"return string.format('%s')",
     "x.lua:1: bad argument #2 to 'format' (no value)"},
    {"return string.format('%', 1)", "x.lua:1: invalid conversion '%' to"},
    {"local s = '' for k in pairs({ [true] = 1, a = 2, [1.5] = 3, [{}] = 4,\n"
     "  [false] = 5, [1] = 6 }) do s = s .. tostring(k) .. ' ' end return s",
     "false true 1 1.5 a table "},
    {"for k in pairs({ [{}] = 1, [{}] = 2 }) do end",
     "x.lua:1: pairs: two keys are tables"},
    {"for k in pairs({ [print] = 1, [error] = 2 }) do end",
     "x.lua:1: pairs: two keys are functions"},
    {"return string.dump(function() end)", "x.lua:1: attempt to call a nil"},
};

START_TEST(addresses_are_hidden) {
  const char *text = outcome(HIDDEN[_i].code);
  ck_assert_msg(strncmp(text, HIDDEN[_i].text, strlen(HIDDEN[_i].text)) == 0,
                "%s: %s", HIDDEN[_i].code, text);
}
END_TEST

START_TEST(sort_sorts) {
  ck_assert_str_eq(
      outcome("local t, n = {}, 1000\n"
              "for i = 1, n do t[i] = i * 7919 % 1009 end table.sort(t)\n"
              "for i = 2, n do assert(t[i - 1] < t[i]) end\n"
              "table.sort(t, function(a, b) return a > b end)\n"
              "for i = 2, n do assert(t[i - 1] > t[i]) end\n"
              "local w = { 'b', 'a', 'c' } table.sort(w)\n"
              "local one = { 1 } table.sort(one) table.sort({})\n"
              "return table.concat(w)"),
      "abc");
  ck_assert_ptr_nonnull(
      strstr(outcome("table.sort({ 1, 'a', 2 })"), "attempt to compare"));
}
END_TEST

#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))

Suite *sandbox_suite(void) {
  Suite *suite = suite_create("sandbox");
  TCase *tcase = tcase_create("sandbox");
  tcase_set_timeout(tcase, 120);
  tcase_add_loop_test(tcase, patterns_are_those_of_lua, 0, COUNT(PATTERNS));
  tcase_add_test(tcase, gmatch_finds_all);
  if (DIM == 2) /* it is the same in three, and takes some seconds */
    tcase_add_loop_test(tcase, c_functions_do_not_take_long, 0, COUNT(ENDLESS));
  tcase_add_test(tcase, nothing_is_repeated_without_end);
  if (DIM == 2) tcase_add_test(tcase, time_is_bounded);
  tcase_add_test(tcase, each_call_has_its_own_bounds);
  tcase_add_loop_test(tcase, addresses_are_hidden, 0, COUNT(HIDDEN));
  tcase_add_test(tcase, sort_sorts);
  suite_add_tcase(suite, tcase);
  return suite;
}
