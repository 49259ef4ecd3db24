#ifndef WAYFUSE_H
#define WAYFUSE_H

/*
 * wayfuse for C, and for every language that calls C.
 *
 * Handles are opaque; NULL is never a valid handle, and every function says so instead of crashing. Text goes in and out as
 * (pointer, length), UTF-8, not necessarily ended by a NUL. Structs that may grow begin with their size: fill them with their
 * *_init function, which takes sizeof as the caller compiled it, so that old programs run with newer libraries. Nothing is
 * ever thrown across this border. Memory given to a callback is valid until it returns.
 *
 * Threads: a phone has one thread of its own. Every function may be called from any thread; they do not block on the network.
 * Callbacks run on the phone's thread, one at a time, and may call any function of this header except wayfuse_phone_destroy,
 * which says WAYFUSE_WRONG_THREAD there.
 *
 * Time is in microseconds of the phone's monotonic clock that counts through sleep: what wayfuse_now_us tells, Android's
 * SensorEvent.timestamp / 1000 and ScanResult.timestamp. Angles are radians; headings run counter-clockwise from east.
 */

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__) || defined(__clang__)
#define WAYFUSE_API __attribute__((visibility("default")))
#else
#define WAYFUSE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Grows when a function or a field is added; 1 is the first. 2 added the calibration. */
#define WAYFUSE_ABI_VERSION 3

typedef enum wayfuse_status {
  WAYFUSE_OK = 0,
  WAYFUSE_BAD_INPUT = 1,     /* a value outside its range; wayfuse_last_error names field and cause */
  WAYFUSE_NULL = 2,          /* a handle or pointer that must not be NULL is NULL */
  WAYFUSE_BAD_OPTIONS = 3,   /* options the library cannot work with; wayfuse_last_error says which */
  WAYFUSE_NO_POSITION = 4,   /* nothing known yet */
  WAYFUSE_BUSY = 5,          /* more input than the phone's thread takes: try again later */
  WAYFUSE_WRONG_STATE = 6,   /* not in this role, or after the end */
  WAYFUSE_WRONG_THREAD = 7,  /* not from inside a callback */
  WAYFUSE_NO_MEMORY = 8,
  WAYFUSE_INTERNAL = 9       /* a bug of ours */
} wayfuse_status;

typedef enum wayfuse_role { WAYFUSE_TRACK = 0, WAYFUSE_SURVEY = 1 } wayfuse_role;

typedef enum wayfuse_state {
  WAYFUSE_IDLE = 0,
  WAYFUSE_CONNECTING = 1,
  WAYFUSE_GREETING = 2,
  WAYFUSE_STREAMING = 3,
  WAYFUSE_BACKING_OFF = 4,
  WAYFUSE_ENDED = 5
} wayfuse_state;

typedef enum wayfuse_platform {
  WAYFUSE_PLATFORM_UNLIMITED = 0,
  WAYFUSE_PLATFORM_ANDROID_FOREGROUND = 1, /* 4 scans in 2 minutes */
  WAYFUSE_PLATFORM_ANDROID_BACKGROUND = 2, /* 1 scan in 30 minutes */
  WAYFUSE_PLATFORM_IOS = 3                 /* no scans */
} wayfuse_platform;

typedef struct wayfuse_text {
  const char* data; /* may be NULL where length is 0 */
  size_t length;
} wayfuse_text;

typedef struct wayfuse_phone wayfuse_phone;

/* ------------------------------------------------------------------ what comes out */

typedef struct wayfuse_position {
  size_t size;
  int64_t at_us;           /* when it is valid */
  double x_m, y_m;         /* in the building's frame */
  int32_t floor;           /* ordinal, 0 = ground */
  int32_t has_geo;         /* latitude and longitude are known */
  double latitude_deg, longitude_deg;
  double radius68_m, radius95_m;
  double heading_rad;      /* of the walker, building frame, counter-clockwise from the x axis */
  double speed_mps;
  int64_t since_fused_us;  /* age of the server's word; larger = reckoned for longer */
  int32_t integrity;       /* 0 ok, 1 degraded, 2 suspect */
  int32_t reserved;
} wayfuse_position;
WAYFUSE_API void wayfuse_position_init(wayfuse_position* position, size_t size);

typedef struct wayfuse_scan_advice {
  size_t size;
  int32_t possible;        /* 0 = this platform lets no application scan */
  int32_t needed;          /* 0 = no scan needed for now */
  int64_t at_us;           /* when to ask the system, if needed */
  wayfuse_text why;        /* for people; valid for ever */
} wayfuse_scan_advice;
WAYFUSE_API void wayfuse_scan_advice_init(wayfuse_scan_advice* advice, size_t size);

/* What the phone has learnt of its sensors and its walker: keep it when the application ends, give it back at the start. */
typedef struct wayfuse_calibration {
  size_t size;
  double turn_rate_bias_radps[3];  /* of the gyroscope, body frame */
  double bias_sigma_radps;         /* per axis; 0 = nothing known */
  double field_offset_ut[3];       /* hard iron, body frame */
  double step_scale;               /* of this walker's steps against the general model, 0.7..1.4 */
  double step_scale_sigma;
} wayfuse_calibration;
WAYFUSE_API void wayfuse_calibration_init(wayfuse_calibration* calibration, size_t size);

/* Called on the phone's thread; any may be NULL. `user` is the one of the options. */
typedef void (*wayfuse_on_position)(void* user, const wayfuse_position* position); /* as the server fused it */
typedef void (*wayfuse_on_state)(void* user, wayfuse_state state);
typedef void (*wayfuse_on_fault)(void* user, int32_t code, wayfuse_text what);     /* numbers as in proto/README.md */
typedef void (*wayfuse_on_disconnected)(void* user, wayfuse_text why);             /* it will try again by itself */
typedef void (*wayfuse_on_samples_lost)(void* user, uint64_t first, uint64_t last);
typedef void (*wayfuse_on_survey_stored)(void* user, wayfuse_text key, uint32_t stored);
/* Before every connection: write a token of at most `capacity` bytes, return its length; more than `capacity` = none. */
typedef size_t (*wayfuse_token)(void* user, char* into, size_t capacity);

/* ------------------------------------------------------------------ a phone */

typedef struct wayfuse_options {
  size_t size;
  wayfuse_text url;               /* wss://host/v1/session; ws:// on loopback only, unless allow_plain */
  wayfuse_text token;             /* a key or session token that does not change; or on_token */
  wayfuse_text device_model;
  wayfuse_text app;
  wayfuse_text pipeline;          /* empty = the building's own */
  wayfuse_text ca_pem;            /* trusted certificates; empty = the system's */
  wayfuse_text pin;               /* base64(SHA-256(SubjectPublicKeyInfo)); empty = none */
  wayfuse_text heading_estimator; /* empty = the best there is */
  uint64_t building;              /* 0 = found from the access points (track only) */
  int32_t role;                   /* a wayfuse_role; a number, so that any value may be read and refused */
  int32_t platform;               /* a wayfuse_platform */
  int32_t allow_plain;
  int32_t reserved;
  uint64_t seed;                  /* of jitter and keys; 0 = from the system */
  void* user;
  wayfuse_token on_token;
  wayfuse_on_position on_position;
  wayfuse_on_state on_state;
  wayfuse_on_fault on_fault;
  wayfuse_on_samples_lost on_samples_lost;
  wayfuse_on_survey_stored on_survey_stored;
  wayfuse_on_disconnected on_disconnected;
  const wayfuse_calibration* calibration; /* from last time; NULL = none. Since 2 */
} wayfuse_options;
WAYFUSE_API void wayfuse_options_init(wayfuse_options* options, size_t size);

/* WAYFUSE_ABI_VERSION of the library, which may be newer than the header. */
WAYFUSE_API uint32_t wayfuse_abi_version(void);
WAYFUSE_API wayfuse_text wayfuse_version(void);
WAYFUSE_API int64_t wayfuse_now_us(void);
WAYFUSE_API wayfuse_text wayfuse_status_text(wayfuse_status status);
/* What the last function of this thread that did not say WAYFUSE_OK had against it; valid until its next call. */
WAYFUSE_API wayfuse_text wayfuse_last_error(void);

/* Options are copied. The phone is idle until wayfuse_phone_start. */
WAYFUSE_API wayfuse_status wayfuse_phone_create(const wayfuse_options* options, wayfuse_phone** phone);
/* Says goodbye, waits for the phone's thread, frees all. NULL is ignored. No callback comes after it. */
WAYFUSE_API wayfuse_status wayfuse_phone_destroy(wayfuse_phone* phone);
WAYFUSE_API wayfuse_status wayfuse_phone_start(wayfuse_phone* phone);
WAYFUSE_API wayfuse_status wayfuse_phone_stop(wayfuse_phone* phone);
WAYFUSE_API wayfuse_status wayfuse_phone_state(wayfuse_phone* phone, wayfuse_state* state);
/* 1 while an operator has what this phone sends written down: show it to whoever carries the phone. It changes with the server's
   word, also in mid-session; 0 before the first. Since 3 */
WAYFUSE_API wayfuse_status wayfuse_phone_is_recorded(wayfuse_phone* phone, uint32_t* is_recorded);
/* The way to the network changed: reconnect now. */
WAYFUSE_API wayfuse_status wayfuse_phone_network_changed(wayfuse_phone* phone);

/* ------------------------------------------------------------------ what goes in */

enum { WAYFUSE_HAS_ACCELERATION = 1, WAYFUSE_HAS_TURN_RATE = 2, WAYFUSE_HAS_FIELD = 4, WAYFUSE_HAS_PRESSURE = 8 };

typedef struct wayfuse_marg_sample {
  int64_t time_us;
  uint32_t has;               /* WAYFUSE_HAS_* of the members that are meant */
  uint32_t reserved;
  double acceleration_mps2[3]; /* x right, y up along the screen, z out of the screen; +9.81 upwards at rest */
  double turn_rate_radps[3];
  double field_ut[3];
  double pressure_hpa;
} wayfuse_marg_sample;

typedef struct wayfuse_reading {
  uint64_t bssid;             /* 48 bits: aa:bb:cc:dd:ee:ff = 0xaabbccddeeff */
  double rss_dbm;             /* -120..0 */
  int64_t heard_us;           /* when this access point was heard: phones hand out caches */
  uint16_t frequency_mhz;     /* 0 = not told */
  uint16_t has_range;
  uint32_t reserved;
  double range_m, range_sigma_m; /* time-of-flight ranging, if has_range */
} wayfuse_reading;

/* In time order. Steps, turns and rest are found and sent by the library. */
WAYFUSE_API wayfuse_status wayfuse_phone_feed_motion(wayfuse_phone* phone, const wayfuse_marg_sample* samples, size_t count);
/* What the system handed over in one go, arrived at `time_us`; of more than 512 readings the youngest count. In the survey role it
   belongs to the walk or the standing point. */
WAYFUSE_API wayfuse_status wayfuse_phone_feed_scan(wayfuse_phone* phone, int64_t time_us, const wayfuse_reading* readings,
                                                   size_t count);
WAYFUSE_API wayfuse_status wayfuse_phone_feed_gnss(wayfuse_phone* phone, int64_t time_us, double latitude_deg,
                                                   double longitude_deg, double sigma_m);

/* Where the phone is at this moment; cheap enough for every frame. WAYFUSE_NO_POSITION before the first. */
WAYFUSE_API wayfuse_status wayfuse_phone_position_now(wayfuse_phone* phone, wayfuse_position* position);

/* What has been learnt so far. Since 2 */
WAYFUSE_API wayfuse_status wayfuse_phone_calibration(wayfuse_phone* phone, wayfuse_calibration* calibration);

/* When to ask the system for a scan. Tell every scan asked for with wayfuse_phone_scan_started. */
WAYFUSE_API wayfuse_status wayfuse_phone_next_scan(wayfuse_phone* phone, wayfuse_scan_advice* advice);
WAYFUSE_API wayfuse_status wayfuse_phone_scan_started(wayfuse_phone* phone);

/* ------------------------------------------------------------------ surveying (role WAYFUSE_SURVEY) */

/* A walk: begin, mark every turn and stop, feed scans, end. The upload follows by itself and is kept until it is stored. */
WAYFUSE_API wayfuse_status wayfuse_survey_begin_walk(wayfuse_phone* phone, wayfuse_text name);
WAYFUSE_API wayfuse_status wayfuse_survey_mark(wayfuse_phone* phone, int64_t time_us, double x_m, double y_m, int32_t floor,
                                               double sigma_m);
WAYFUSE_API wayfuse_status wayfuse_survey_end_walk(wayfuse_phone* phone);
/* A standing point: begin, feed scans, end. */
WAYFUSE_API wayfuse_status wayfuse_survey_begin_point(wayfuse_phone* phone, double x_m, double y_m, int32_t floor, double sigma_m);
WAYFUSE_API wayfuse_status wayfuse_survey_end_point(wayfuse_phone* phone);
/* Batches not yet known to be stored. */
WAYFUSE_API wayfuse_status wayfuse_survey_waiting(wayfuse_phone* phone, size_t* batches);

#ifdef __cplusplus
}
#endif

#endif
