#ifndef WAYFUSE_TESTS_C_CALLS_H
#define WAYFUSE_TESTS_C_CALLS_H

#include "wayfuse/sdk/wayfuse.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Rung by callbacks; waits until it was rung `times` times altogether, 0 = that did not happen in 20 s. */
typedef struct c_bell {
  void *itself;
  void (*ring)(void *itself);
  int (*wait)(void *itself, int times);
} c_bell;

const char *c_null_is_refused(void);
const char *c_options_are_checked(void);
const char *c_bad_input_is_named(const char *url);
const char *c_tracks(const char *url, c_bell bell);
const char *c_surveys(const char *url, c_bell bell);

#ifdef __cplusplus
}
#endif

#endif
