#ifndef WAYFUSE_TESTS_C_CALLS_H
#define WAYFUSE_TESTS_C_CALLS_H

#include "wayfuse/sdk/wayfuse.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef void (*c_wait)(void);

const char *c_null_is_refused(void);
const char *c_options_are_checked(void);
const char *c_bad_input_is_named(const char *url);
const char *c_tracks(const char *url, c_wait wait);
const char *c_surveys(const char *url, c_wait wait);

#ifdef __cplusplus
}
#endif

#endif
