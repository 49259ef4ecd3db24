/* From zero to a moving dot in C: one phone, sensors in, a position out sixty times a second.
 *
 *   cc moving_dot.c $(pkg-config --cflags --libs wayfuse) -o moving_dot && ./moving_dot ws://127.0.0.1:8420/v1/session KEY 1
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <wayfuse/sdk/wayfuse.h>

static wayfuse_text text(const char *s) { wayfuse_text t = {s, strlen(s)}; return t; }

static void on_fault(void *user, int32_t code, wayfuse_text what) {
  (void)user, (void)code;
  fprintf(stderr, "%.*s\n", (int)what.length, what.data);
}

int main(int count, char **words) {
  if (count < 4) return fprintf(stderr, "usage: moving_dot URL KEY BUILDING [SECONDS]\n"), 2;
  wayfuse_options options;
  wayfuse_options_init(&options, sizeof options);
  options.url = text(words[1]);
  options.token = text(words[2]);
  options.building = strtoull(words[3], NULL, 10);
  options.device_model = text("example");
  options.on_fault = on_fault;
  wayfuse_phone *phone = NULL;
  if (wayfuse_phone_create(&options, &phone) != WAYFUSE_OK || wayfuse_phone_start(phone) != WAYFUSE_OK) {
    const wayfuse_text why = wayfuse_last_error();
    return fprintf(stderr, "%.*s\n", (int)why.length, why.data), 1;
  }
  for (int frame = 0; frame < 60 * (count > 4 ? atoi(words[4]) : 60); ++frame) {
    wayfuse_marg_sample still = {0}; /* your SensorEvents go here: lying still, screen up, facing north */
    still.time_us = wayfuse_now_us();
    still.has = WAYFUSE_HAS_ACCELERATION | WAYFUSE_HAS_TURN_RATE | WAYFUSE_HAS_FIELD;
    still.acceleration_mps2[2] = 9.81, still.field_ut[1] = 22, still.field_ut[2] = -42;
    wayfuse_phone_feed_motion(phone, &still, 1);
    if (frame % 120 == 0) { /* and your ScanResults here, each with the time it was heard: these live in the demo building */
      const int64_t at = still.time_us - 1000;
      const wayfuse_reading heard[3] = {{0x001b2cf0b531, -47.0, at, 5260, 0, 0, 0.0, 0.0},
                                        {0x001b2c6f7b01, -51.0, at, 5500, 0, 0, 0.0, 0.0},
                                        {0x001b2c4e66e1, -79.0, at, 5500, 0, 0, 0.0, 0.0}};
      wayfuse_phone_feed_scan(phone, still.time_us, heard, 3);
    }
    wayfuse_position dot;
    wayfuse_position_init(&dot, sizeof dot);
    if (frame % 60 == 59 && wayfuse_phone_position_now(phone, &dot) == WAYFUSE_OK)
      printf("%.2f m, %.2f m, floor %d, within %.1f m\n", dot.x_m, dot.y_m, (int)dot.floor, dot.radius68_m);
    nanosleep(&(struct timespec){0, 16666667}, NULL);
  }
  return wayfuse_phone_destroy(phone) == WAYFUSE_OK ? 0 : 1;
}
