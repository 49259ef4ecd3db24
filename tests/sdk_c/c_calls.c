/* The C interface as C sees it: compiled as C99 with every warning, each an error. NULL = all is well, else what failed. */
#include "tests/sdk_c/c_calls.h"

#include <string.h>

#define MANY 600
#define STRINGIFY(x) #x
#define AS_TEXT(x) STRINGIFY(x)
#define REQUIRE(condition) do { if (!(condition)) return "c_calls.c:" AS_TEXT(__LINE__) ": " #condition; } while (0)

static wayfuse_text text(const char *s) {
  wayfuse_text made;
  made.data = s;
  made.length = strlen(s);
  return made;
}

static int says(wayfuse_text given, const char *part) {
  const size_t length = strlen(part);
  size_t at;
  for (at = 0; at + length <= given.length; ++at) {
    if (memcmp(given.data + at, part, length) == 0) return 1;
  }
  return 0;
}

const char *c_null_is_refused(void) {
  wayfuse_phone *phone = NULL;
  wayfuse_position position;
  wayfuse_scan_advice advice;
  wayfuse_state state;
  size_t waiting;
  wayfuse_options options;
  const wayfuse_text no_text = {NULL, 3};
  wayfuse_position_init(&position, sizeof position);
  wayfuse_scan_advice_init(&advice, sizeof advice);
  wayfuse_options_init(&options, sizeof options);
  wayfuse_options_init(NULL, 0);
  wayfuse_position_init(NULL, 8);
  REQUIRE(wayfuse_phone_create(NULL, &phone) == WAYFUSE_NULL);
  REQUIRE(wayfuse_phone_create(&options, NULL) == WAYFUSE_NULL);
  REQUIRE(wayfuse_phone_destroy(NULL) == WAYFUSE_OK);
  REQUIRE(wayfuse_phone_start(NULL) == WAYFUSE_NULL);
  REQUIRE(wayfuse_phone_stop(NULL) == WAYFUSE_NULL);
  REQUIRE(wayfuse_phone_state(NULL, &state) == WAYFUSE_NULL);
  REQUIRE(wayfuse_phone_network_changed(NULL) == WAYFUSE_NULL);
  REQUIRE(wayfuse_phone_feed_motion(NULL, NULL, 0) == WAYFUSE_NULL);
  REQUIRE(wayfuse_phone_feed_scan(NULL, 0, NULL, 0) == WAYFUSE_NULL);
  REQUIRE(wayfuse_phone_feed_gnss(NULL, 0, 0, 0, 0) == WAYFUSE_NULL);
  REQUIRE(wayfuse_phone_position_now(NULL, &position) == WAYFUSE_NULL);
  REQUIRE(wayfuse_phone_next_scan(NULL, &advice) == WAYFUSE_NULL);
  REQUIRE(wayfuse_phone_calibration(NULL, NULL) == WAYFUSE_NULL);
  REQUIRE(wayfuse_phone_is_recorded(NULL, NULL) == WAYFUSE_NULL);
  REQUIRE(wayfuse_phone_scan_started(NULL) == WAYFUSE_NULL);
  REQUIRE(wayfuse_survey_begin_walk(NULL, text("w")) == WAYFUSE_NULL);
  REQUIRE(wayfuse_survey_mark(NULL, 0, 0, 0, 0, 0) == WAYFUSE_NULL);
  REQUIRE(wayfuse_survey_end_walk(NULL) == WAYFUSE_NULL);
  REQUIRE(wayfuse_survey_begin_point(NULL, 0, 0, 0, 0) == WAYFUSE_NULL);
  REQUIRE(wayfuse_survey_end_point(NULL) == WAYFUSE_NULL);
  REQUIRE(wayfuse_survey_waiting(NULL, &waiting) == WAYFUSE_NULL);
  REQUIRE(says(wayfuse_last_error(), "phone is NULL"));
  options.url = no_text;
  REQUIRE(wayfuse_phone_create(&options, &phone) == WAYFUSE_NULL);
  REQUIRE(phone == NULL);
  return NULL;
}

const char *c_options_are_checked(void) {
  wayfuse_options options;
  wayfuse_phone *phone = NULL;
  struct {
    wayfuse_options known;
    char unknown[16];
  } newer;
  memset(&options, 0, sizeof options);
  REQUIRE(wayfuse_phone_create(&options, &phone) == WAYFUSE_BAD_OPTIONS); /* no init */
  REQUIRE(says(wayfuse_last_error(), "wayfuse_options_init"));
  wayfuse_options_init(&options, sizeof options);
  REQUIRE(wayfuse_phone_create(&options, &phone) == WAYFUSE_BAD_OPTIONS); /* no address */
  REQUIRE(says(wayfuse_last_error(), "url"));
  options.url = text("ws://127.0.0.1:9/");
  options.role = 7;
  REQUIRE(wayfuse_phone_create(&options, &phone) == WAYFUSE_BAD_OPTIONS);
  options.role = WAYFUSE_SURVEY;
  REQUIRE(wayfuse_phone_create(&options, &phone) == WAYFUSE_BAD_OPTIONS); /* no building */
  options.role = WAYFUSE_TRACK;
  options.platform = -1;
  REQUIRE(wayfuse_phone_create(&options, &phone) == WAYFUSE_BAD_OPTIONS);
  options.platform = WAYFUSE_PLATFORM_IOS;
  options.heading_estimator = text("none such");
  REQUIRE(wayfuse_phone_create(&options, &phone) == WAYFUSE_BAD_OPTIONS);
  options.heading_estimator = text("complementary");
  REQUIRE(wayfuse_phone_create(&options, &phone) == WAYFUSE_OK);
  REQUIRE(wayfuse_phone_destroy(phone) == WAYFUSE_OK);
  phone = NULL;
  /* A program compiled against a newer header: fine, as long as it asks for nothing unknown. */
  wayfuse_options_init(&newer.known, sizeof newer);
  newer.known.url = text("ws://127.0.0.1:9/");
  REQUIRE(wayfuse_phone_create(&newer.known, &phone) == WAYFUSE_OK);
  REQUIRE(wayfuse_phone_destroy(phone) == WAYFUSE_OK);
  phone = NULL;
  newer.unknown[3] = 1;
  REQUIRE(wayfuse_phone_create(&newer.known, &phone) == WAYFUSE_BAD_OPTIONS);
  REQUIRE(wayfuse_abi_version() == WAYFUSE_ABI_VERSION);
  REQUIRE(wayfuse_version().length > 0);
  REQUIRE(wayfuse_status_text((wayfuse_status)1234).length > 0);
  return NULL;
}

const char *c_bad_input_is_named(const char *url) {
  wayfuse_options options;
  wayfuse_phone *phone = NULL;
  wayfuse_position position;
  wayfuse_scan_advice advice;
  wayfuse_calibration calibration;
  wayfuse_phone *second = NULL;
  wayfuse_state state = WAYFUSE_ENDED;
  wayfuse_reading reading;
  static wayfuse_reading many[MANY];
  uint32_t is_recorded = 9;
  size_t waiting = 9;
  memset(&reading, 0, sizeof reading);
  wayfuse_options_init(&options, sizeof options);
  options.url = text(url);
  options.platform = WAYFUSE_PLATFORM_IOS;
  REQUIRE(wayfuse_phone_create(&options, &phone) == WAYFUSE_OK);
  REQUIRE(wayfuse_phone_state(phone, &state) == WAYFUSE_OK && state == WAYFUSE_IDLE);
  reading.bssid = 1;
  reading.rss_dbm = -312;
  reading.heard_us = 1000;
  REQUIRE(wayfuse_phone_feed_scan(phone, 1000, &reading, 1) == WAYFUSE_BAD_INPUT);
  REQUIRE(says(wayfuse_last_error(), "rss_dbm"));
  reading.rss_dbm = -50;
  REQUIRE(wayfuse_phone_feed_scan(phone, 1000, &reading, 100000) == WAYFUSE_BAD_INPUT);
  for (size_t i = 0; i < MANY; ++i) {
    many[i] = reading;
    many[i].bssid = i + 1;
  }
  REQUIRE(wayfuse_phone_feed_scan(phone, 1000, many, MANY) == WAYFUSE_OK); /* longer than a message: the youngest count */
  reading.heard_us = INT64_MIN;
  REQUIRE(wayfuse_phone_feed_scan(phone, INT64_MAX, &reading, 1) == WAYFUSE_BAD_INPUT);
  REQUIRE(wayfuse_phone_feed_gnss(phone, 0, 91, 0, 1) == WAYFUSE_BAD_INPUT);
  REQUIRE(wayfuse_phone_feed_motion(phone, NULL, 0) == WAYFUSE_OK);
  REQUIRE(wayfuse_phone_feed_motion(phone, NULL, 1) == WAYFUSE_NULL);
  wayfuse_position_init(&position, sizeof position);
  REQUIRE(wayfuse_phone_position_now(phone, &position) == WAYFUSE_NO_POSITION);
  memset(&advice, 0, sizeof advice);
  REQUIRE(wayfuse_phone_next_scan(phone, &advice) == WAYFUSE_BAD_INPUT); /* no init */
  wayfuse_scan_advice_init(&advice, sizeof advice);
  REQUIRE(wayfuse_phone_next_scan(phone, &advice) == WAYFUSE_OK);
  REQUIRE(!advice.possible && says(advice.why, "iOS"));
  REQUIRE(wayfuse_phone_is_recorded(phone, &is_recorded) == WAYFUSE_OK && is_recorded == 0);
  memset(&calibration, 0, sizeof calibration);
  REQUIRE(wayfuse_phone_calibration(phone, &calibration) == WAYFUSE_BAD_INPUT); /* no init */
  wayfuse_calibration_init(&calibration, sizeof calibration);
  REQUIRE(wayfuse_phone_calibration(phone, &calibration) == WAYFUSE_OK);
  REQUIRE(calibration.step_scale > 0.99 && calibration.step_scale < 1.01); /* nothing learnt yet */
  options.calibration = &calibration;
  calibration.step_scale = 1.2;
  REQUIRE(wayfuse_phone_create(&options, &second) == WAYFUSE_OK);
  calibration.step_scale = 1;
  REQUIRE(wayfuse_phone_calibration(second, &calibration) == WAYFUSE_OK);
  REQUIRE(calibration.step_scale > 1.19 && calibration.step_scale < 1.21); /* what was kept came back */
  REQUIRE(wayfuse_phone_destroy(second) == WAYFUSE_OK);
  calibration.turn_rate_bias_radps[1] = 5;
  REQUIRE(wayfuse_phone_create(&options, &second) == WAYFUSE_BAD_OPTIONS);
  REQUIRE(says(wayfuse_last_error(), "turn_rate_bias_radps"));
  REQUIRE(wayfuse_survey_end_walk(phone) != WAYFUSE_OK);
  REQUIRE(wayfuse_survey_end_point(phone) == WAYFUSE_WRONG_STATE);
  REQUIRE(wayfuse_survey_waiting(phone, &waiting) == WAYFUSE_OK && waiting == 0);
  REQUIRE(wayfuse_phone_destroy(phone) == WAYFUSE_OK);
  return NULL;
}

struct told {
  wayfuse_phone *phone;
  c_bell bell;
  int positions;
  int streaming;
  int stored;
  int wrong_thread;
};

static void on_position(void *user, const wayfuse_position *position) {
  struct told *told = (struct told *)user;
  if (position->size == sizeof *position) ++told->positions;
  if (told->phone && wayfuse_phone_destroy(told->phone) == WAYFUSE_WRONG_THREAD) told->wrong_thread = 1;
  told->bell.ring(told->bell.itself);
}
static void on_state(void *user, wayfuse_state state) {
  if (state == WAYFUSE_STREAMING) ((struct told *)user)->streaming = 1;
}
static void on_stored(void *user, wayfuse_text key, uint32_t stored) {
  struct told *told = (struct told *)user;
  if (key.length > 0) told->stored += (int)stored;
  told->bell.ring(told->bell.itself);
}
static size_t give_token(void *user, char *into, size_t capacity) {
  (void)user;
  if (capacity < 3) return capacity + 1;
  memcpy(into, "key", 3);
  return 3;
}

const char *c_tracks(const char *url, c_bell bell) {
  struct told told;
  wayfuse_options options;
  wayfuse_position position;
  int64_t now_us;
  int i;
  memset(&told, 0, sizeof told);
  told.bell = bell;
  wayfuse_options_init(&options, sizeof options);
  options.url = text(url);
  options.device_model = text("c");
  options.building = 1;
  options.user = &told;
  options.on_token = give_token;
  options.on_position = on_position;
  options.on_state = on_state;
  REQUIRE(wayfuse_phone_create(&options, &told.phone) == WAYFUSE_OK);
  REQUIRE(wayfuse_phone_start(told.phone) == WAYFUSE_OK);
  wayfuse_position_init(&position, sizeof position);
  now_us = wayfuse_now_us();
  for (i = 50; i >= 0; --i) { /* the last second, lying still */
    wayfuse_marg_sample sample;
    memset(&sample, 0, sizeof sample);
    sample.time_us = now_us - i * 20000;
    sample.has = WAYFUSE_HAS_ACCELERATION | WAYFUSE_HAS_TURN_RATE | WAYFUSE_HAS_FIELD;
    sample.acceleration_mps2[2] = 9.81;
    sample.field_ut[1] = 22;
    sample.field_ut[2] = -42;
    REQUIRE(wayfuse_phone_feed_motion(told.phone, &sample, 1) == WAYFUSE_OK);
  }
  REQUIRE(bell.wait(bell.itself, 1));
  REQUIRE(wayfuse_phone_position_now(told.phone, &position) == WAYFUSE_OK);
  REQUIRE(position.x_m > 2.9 && position.x_m < 3.1);
  REQUIRE(position.floor == 2);
  REQUIRE(wayfuse_phone_stop(told.phone) == WAYFUSE_OK);
  REQUIRE(wayfuse_phone_destroy(told.phone) == WAYFUSE_OK);
  REQUIRE(told.streaming == 1);
  REQUIRE(told.positions >= 1);
  REQUIRE(told.wrong_thread == 1);
  return NULL;
}

const char *c_surveys(const char *url, c_bell bell) {
  struct told told;
  wayfuse_options options;
  wayfuse_reading reading;
  size_t waiting = 1;
  memset(&told, 0, sizeof told);
  told.bell = bell;
  memset(&reading, 0, sizeof reading);
  reading.bssid = 0xaabbccddeeff;
  reading.rss_dbm = -50;
  wayfuse_options_init(&options, sizeof options);
  options.url = text(url);
  options.building = 1;
  options.role = WAYFUSE_SURVEY;
  options.user = &told;
  options.on_survey_stored = on_stored;
  REQUIRE(wayfuse_phone_create(&options, &told.phone) == WAYFUSE_OK);
  REQUIRE(wayfuse_phone_start(told.phone) == WAYFUSE_OK);
  reading.heard_us = 5000000;
  REQUIRE(wayfuse_phone_feed_scan(told.phone, 5000000, &reading, 1) == WAYFUSE_WRONG_STATE);
  REQUIRE(wayfuse_survey_begin_walk(told.phone, text("w")) == WAYFUSE_OK);
  REQUIRE(wayfuse_survey_mark(told.phone, 1000000, 0, 0, 0, 0.3) == WAYFUSE_OK);
  REQUIRE(wayfuse_phone_feed_scan(told.phone, 5000000, &reading, 1) == WAYFUSE_OK);
  REQUIRE(wayfuse_survey_mark(told.phone, 9000000, 8, 0, 0, 0.3) == WAYFUSE_OK);
  REQUIRE(wayfuse_survey_end_walk(told.phone) == WAYFUSE_OK);
  REQUIRE(wayfuse_survey_begin_point(told.phone, 1, 1, 0, 0.1) == WAYFUSE_OK);
  REQUIRE(wayfuse_survey_end_point(told.phone) == WAYFUSE_BAD_INPUT); /* without a scan there is no point */
  REQUIRE(wayfuse_survey_begin_point(told.phone, 1, 1, 0, 0.1) == WAYFUSE_OK);
  REQUIRE(wayfuse_phone_feed_scan(told.phone, 5000000, &reading, 1) == WAYFUSE_OK);
  REQUIRE(wayfuse_survey_end_point(told.phone) == WAYFUSE_OK);
  REQUIRE(bell.wait(bell.itself, 2)); /* the walk and the point */
  REQUIRE(wayfuse_survey_waiting(told.phone, &waiting) == WAYFUSE_OK);
  REQUIRE(waiting == 0);
  REQUIRE(wayfuse_phone_destroy(told.phone) == WAYFUSE_OK);
  REQUIRE(told.stored == 2);
  return NULL;
}
