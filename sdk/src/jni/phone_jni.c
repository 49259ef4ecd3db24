/* org.wayfuse.Phone over the C interface. A status that is not WAYFUSE_OK becomes an exception with wayfuse_last_error's words;
 * a phone's thread attaches itself to the JVM as a daemon for its callbacks. */
#include <jni.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "wayfuse/sdk/wayfuse.h"

struct binding {
  JavaVM *jvm;
  jobject listener; /* global */
  jclass position;  /* global */
  jmethodID make_position, on_position, on_state, on_fault, on_lost, on_disconnected, token;
  wayfuse_phone *phone;
};

static JNIEnv *env_of(struct binding *b) {
  void *env = NULL;
  if ((*b->jvm)->GetEnv(b->jvm, &env, JNI_VERSION_1_6) == JNI_OK) return (JNIEnv *)env;
  return (*b->jvm)->AttachCurrentThreadAsDaemon(b->jvm, &env, NULL) == JNI_OK ? (JNIEnv *)env : NULL;
}

/* An exception of the listener is its own affair: it must not travel through the phone's thread. */
static void swallow(JNIEnv *env) {
  if (!(*env)->ExceptionCheck(env)) return;
  (*env)->ExceptionDescribe(env);
  (*env)->ExceptionClear(env);
}

/* A Java string of text that came from outside and may be no valid UTF-8: what is not ASCII becomes '?'. */
static jstring string_of(JNIEnv *env, wayfuse_text text) {
  char plain[1024];
  size_t at = 0;
  for (; at < text.length && at + 1 < sizeof plain; ++at) {
    const unsigned char c = (unsigned char)text.data[at];
    plain[at] = (char)(c >= 32 && c < 127 ? c : '?');
  }
  plain[at] = '\0';
  return (*env)->NewStringUTF(env, plain);
}

static void throw_java(JNIEnv *env, const char *name, wayfuse_text why) {
  char words[600];
  const size_t length = why.length < sizeof words - 1 ? why.length : sizeof words - 1;
  jclass type = (*env)->FindClass(env, name);
  if (!type) return;
  if (length) memcpy(words, why.data, length);
  words[length] = '\0';
  (*env)->ThrowNew(env, type, words);
}

static int check(JNIEnv *env, wayfuse_status status) {
  if (status == WAYFUSE_OK) return 1;
  switch (status) {
    case WAYFUSE_BAD_INPUT:
    case WAYFUSE_BAD_OPTIONS:
    case WAYFUSE_NULL:
      throw_java(env, "java/lang/IllegalArgumentException", wayfuse_last_error());
      break;
    case WAYFUSE_NO_MEMORY:
      throw_java(env, "java/lang/OutOfMemoryError", wayfuse_last_error());
      break;
    default:
      throw_java(env, "java/lang/IllegalStateException", wayfuse_last_error());
      break;
  }
  return 0;
}

static jobject position_of(JNIEnv *env, const struct binding *b, const wayfuse_position *p) {
  const double nowhere = NAN;
  return (*env)->NewObject(env, b->position, b->make_position, (jlong)p->at_us, p->x_m, p->y_m, (jint)p->floor,
                           p->has_geo ? p->latitude_deg : nowhere, p->has_geo ? p->longitude_deg : nowhere, p->radius68_m,
                           p->radius95_m, p->heading_rad, p->speed_mps, (jlong)p->since_fused_us);
}

static void on_position(void *user, const wayfuse_position *position) {
  struct binding *b = (struct binding *)user;
  JNIEnv *env = env_of(b);
  jobject told;
  if (!env || (*env)->PushLocalFrame(env, 8) != 0) return;
  told = position_of(env, b, position);
  if (told) (*env)->CallVoidMethod(env, b->listener, b->on_position, told);
  swallow(env);
  (*env)->PopLocalFrame(env, NULL);
}

static void on_state(void *user, wayfuse_state state) {
  struct binding *b = (struct binding *)user;
  JNIEnv *env = env_of(b);
  if (!env) return;
  (*env)->CallVoidMethod(env, b->listener, b->on_state, (jint)state);
  swallow(env);
}

static void on_fault(void *user, int32_t code, wayfuse_text what) {
  struct binding *b = (struct binding *)user;
  JNIEnv *env = env_of(b);
  if (!env || (*env)->PushLocalFrame(env, 8) != 0) return;
  (*env)->CallVoidMethod(env, b->listener, b->on_fault, (jint)code, string_of(env, what));
  swallow(env);
  (*env)->PopLocalFrame(env, NULL);
}

static void on_disconnected(void *user, wayfuse_text why) {
  struct binding *b = (struct binding *)user;
  JNIEnv *env = env_of(b);
  if (!env || (*env)->PushLocalFrame(env, 8) != 0) return;
  (*env)->CallVoidMethod(env, b->listener, b->on_disconnected, string_of(env, why));
  swallow(env);
  (*env)->PopLocalFrame(env, NULL);
}

static void on_lost(void *user, uint64_t first, uint64_t last) {
  struct binding *b = (struct binding *)user;
  JNIEnv *env = env_of(b);
  if (!env) return;
  (*env)->CallVoidMethod(env, b->listener, b->on_lost, (jlong)first, (jlong)last);
  swallow(env);
}

static size_t give_token(void *user, char *into, size_t capacity) {
  struct binding *b = (struct binding *)user;
  JNIEnv *env = env_of(b);
  size_t length = 0;
  jstring token;
  if (!env || (*env)->PushLocalFrame(env, 8) != 0) return 0;
  token = (jstring)(*env)->CallObjectMethod(env, b->listener, b->token);
  swallow(env);
  if (token) {
    length = (size_t)(*env)->GetStringUTFLength(env, token);
    if (length < capacity) (*env)->GetStringUTFRegion(env, token, 0, (*env)->GetStringLength(env, token), into);
  }
  (*env)->PopLocalFrame(env, NULL);
  return length < capacity ? length : capacity + 1;
}

static void release(JNIEnv *env, struct binding *b) {
  if (b->listener) (*env)->DeleteGlobalRef(env, b->listener);
  if (b->position) (*env)->DeleteGlobalRef(env, b->position);
  free(b);
}

static struct binding *bind(JNIEnv *env, jobject listener) {
  struct binding *b = (struct binding *)calloc(1, sizeof *b);
  jclass type, position;
  if (!b) return NULL;
  type = (*env)->GetObjectClass(env, listener);
  position = (*env)->FindClass(env, "org/wayfuse/Phone$Position");
  if (!position || (*env)->GetJavaVM(env, &b->jvm) != JNI_OK) {
    free(b);
    return NULL;
  }
  b->listener = (*env)->NewGlobalRef(env, listener);
  b->position = (jclass)(*env)->NewGlobalRef(env, position);
  b->make_position = (*env)->GetMethodID(env, position, "<init>", "(JDDIDDDDDDJ)V");
  b->on_position = (*env)->GetMethodID(env, type, "onPosition", "(Lorg/wayfuse/Phone$Position;)V");
  b->on_state = (*env)->GetMethodID(env, type, "onState", "(I)V");
  b->on_fault = (*env)->GetMethodID(env, type, "onFault", "(ILjava/lang/String;)V");
  b->on_lost = (*env)->GetMethodID(env, type, "onSamplesLost", "(JJ)V");
  b->on_disconnected = (*env)->GetMethodID(env, type, "onDisconnected", "(Ljava/lang/String;)V");
  b->token = (*env)->GetMethodID(env, type, "token", "()Ljava/lang/String;");
  if (!(*env)->ExceptionCheck(env) && b->listener && b->position) return b;
  release(env, b);
  return NULL;
}

static wayfuse_text text_of(JNIEnv *env, jstring string, const char **held) {
  wayfuse_text text = {NULL, 0};
  *held = string ? (*env)->GetStringUTFChars(env, string, NULL) : NULL;
  if (*held) {
    text.data = *held;
    text.length = strlen(*held);
  }
  return text;
}

/* A calibration as Java keeps it: its numbers in the order of the struct. */
enum { CALIBRATION_LENGTH = 9 };
static wayfuse_calibration calibration_of(const jdouble *numbers) {
  wayfuse_calibration calibration;
  wayfuse_calibration_init(&calibration, sizeof calibration);
  memcpy(calibration.turn_rate_bias_radps, numbers, 3 * sizeof *numbers);
  calibration.bias_sigma_radps = numbers[3];
  memcpy(calibration.field_offset_ut, numbers + 4, 3 * sizeof *numbers);
  calibration.step_scale = numbers[7];
  calibration.step_scale_sigma = numbers[8];
  return calibration;
}

static struct binding *of(jlong handle) { return (struct binding *)(intptr_t)handle; }

JNIEXPORT jlong JNICALL Java_org_wayfuse_Phone_create(JNIEnv *env, jclass self, jstring url, jlong building, jstring model,
                                                      jboolean background, jobject listener, jdoubleArray kept) {
  wayfuse_options options;
  wayfuse_calibration calibration;
  const char *held_url, *held_model;
  wayfuse_status status;
  struct binding *b = bind(env, listener);
  (void)self;
  if (!b) return 0;
  wayfuse_options_init(&options, sizeof options);
  options.url = text_of(env, url, &held_url);
  options.device_model = text_of(env, model, &held_model);
  options.building = (uint64_t)building;
  options.platform = background ? WAYFUSE_PLATFORM_ANDROID_BACKGROUND : WAYFUSE_PLATFORM_ANDROID_FOREGROUND;
  options.user = b;
  options.on_token = give_token;
  options.on_position = on_position;
  options.on_state = on_state;
  options.on_fault = on_fault;
  options.on_samples_lost = on_lost;
  options.on_disconnected = on_disconnected;
  if (kept) {
    jdouble numbers[CALIBRATION_LENGTH];
    (*env)->GetDoubleArrayRegion(env, kept, 0, CALIBRATION_LENGTH, numbers);
    calibration = calibration_of(numbers);
    options.calibration = &calibration;
  }
  status = wayfuse_phone_create(&options, &b->phone);
  if (held_url) (*env)->ReleaseStringUTFChars(env, url, held_url);
  if (held_model) (*env)->ReleaseStringUTFChars(env, model, held_model);
  if (check(env, status)) return (jlong)(intptr_t)b;
  release(env, b);
  return 0;
}

JNIEXPORT void JNICALL Java_org_wayfuse_Phone_destroy(JNIEnv *env, jclass self, jlong handle) {
  (void)self;
  if (check(env, wayfuse_phone_destroy(of(handle)->phone))) release(env, of(handle));
}
JNIEXPORT void JNICALL Java_org_wayfuse_Phone_start(JNIEnv *env, jclass self, jlong handle) {
  (void)self;
  check(env, wayfuse_phone_start(of(handle)->phone));
}
JNIEXPORT void JNICALL Java_org_wayfuse_Phone_stop(JNIEnv *env, jclass self, jlong handle) {
  (void)self;
  check(env, wayfuse_phone_stop(of(handle)->phone));
}
JNIEXPORT void JNICALL Java_org_wayfuse_Phone_networkChanged(JNIEnv *env, jclass self, jlong handle) {
  (void)self;
  check(env, wayfuse_phone_network_changed(of(handle)->phone));
}

/* Sensor.TYPE_* to members; an unknown type leaves `has` at 0. */
static wayfuse_marg_sample sample_of(jint type, jlong time_ns, const jfloat *values) {
  wayfuse_marg_sample sample;
  double *axes = NULL;
  memset(&sample, 0, sizeof sample);
  sample.time_us = time_ns / 1000;
  if (type == 1) sample.has = WAYFUSE_HAS_ACCELERATION, axes = sample.acceleration_mps2;
  if (type == 2 || type == 14) sample.has = WAYFUSE_HAS_FIELD, axes = sample.field_ut;
  if (type == 4 || type == 16) sample.has = WAYFUSE_HAS_TURN_RATE, axes = sample.turn_rate_radps;
  if (axes) axes[0] = values[0], axes[1] = values[1], axes[2] = values[2];
  if (type == 6) sample.has = WAYFUSE_HAS_PRESSURE, sample.pressure_hpa = values[0];
  return sample;
}

JNIEXPORT void JNICALL Java_org_wayfuse_Phone_feedMotion(JNIEnv *env, jclass self, jlong handle, jintArray types, jlongArray times,
                                                         jfloatArray values) {
  const jsize count = (*env)->GetArrayLength(env, types);
  jsize at;
  (void)self;
  for (at = 0; at < count; ++at) {
    jint type;
    jlong time_ns;
    jfloat axes[3];
    wayfuse_marg_sample sample;
    (*env)->GetIntArrayRegion(env, types, at, 1, &type);
    (*env)->GetLongArrayRegion(env, times, at, 1, &time_ns);
    (*env)->GetFloatArrayRegion(env, values, 3 * at, 3, axes);
    sample = sample_of(type, time_ns, axes);
    if (sample.has && !check(env, wayfuse_phone_feed_motion(of(handle)->phone, &sample, 1))) return;
  }
}

JNIEXPORT void JNICALL Java_org_wayfuse_Phone_feedScan(JNIEnv *env, jclass self, jlong handle, jlong arrived_us, jlongArray bssids,
                                                       jintArray levels, jintArray frequencies, jlongArray heard) {
  const jsize count = (*env)->GetArrayLength(env, bssids);
  wayfuse_reading *readings = (wayfuse_reading *)calloc(count > 0 ? (size_t)count : 1, sizeof *readings);
  jsize at;
  (void)self;
  if (!readings) return throw_java(env, "java/lang/OutOfMemoryError", wayfuse_status_text(WAYFUSE_NO_MEMORY));
  for (at = 0; at < count; ++at) {
    jlong bssid, heard_us;
    jint level, frequency;
    (*env)->GetLongArrayRegion(env, bssids, at, 1, &bssid);
    (*env)->GetLongArrayRegion(env, heard, at, 1, &heard_us);
    (*env)->GetIntArrayRegion(env, levels, at, 1, &level);
    (*env)->GetIntArrayRegion(env, frequencies, at, 1, &frequency);
    readings[at].bssid = (uint64_t)bssid;
    readings[at].rss_dbm = level;
    readings[at].heard_us = heard_us > arrived_us ? arrived_us : heard_us; /* heard while the list was handed over */
    readings[at].frequency_mhz = (uint16_t)(frequency > 0 && frequency < 65536 ? frequency : 0);
  }
  check(env, wayfuse_phone_feed_scan(of(handle)->phone, arrived_us, readings, (size_t)count));
  free(readings);
}

JNIEXPORT void JNICALL Java_org_wayfuse_Phone_feedGnss(JNIEnv *env, jclass self, jlong handle, jlong time_us, jdouble latitude,
                                                       jdouble longitude, jdouble accuracy) {
  (void)self;
  check(env, wayfuse_phone_feed_gnss(of(handle)->phone, time_us, latitude, longitude, accuracy));
}

JNIEXPORT jobject JNICALL Java_org_wayfuse_Phone_positionNow(JNIEnv *env, jclass self, jlong handle) {
  wayfuse_position position;
  wayfuse_status status;
  (void)self;
  wayfuse_position_init(&position, sizeof position);
  status = wayfuse_phone_position_now(of(handle)->phone, &position);
  if (status == WAYFUSE_NO_POSITION || !check(env, status)) return NULL;
  return position_of(env, of(handle), &position);
}

JNIEXPORT jdoubleArray JNICALL Java_org_wayfuse_Phone_calibration(JNIEnv *env, jclass self, jlong handle) {
  wayfuse_calibration learnt;
  jdoubleArray kept;
  (void)self;
  wayfuse_calibration_init(&learnt, sizeof learnt);
  if (!check(env, wayfuse_phone_calibration(of(handle)->phone, &learnt))) return NULL;
  kept = (*env)->NewDoubleArray(env, CALIBRATION_LENGTH);
  if (!kept) return NULL;
  (*env)->SetDoubleArrayRegion(env, kept, 0, 3, learnt.turn_rate_bias_radps);
  (*env)->SetDoubleArrayRegion(env, kept, 3, 1, &learnt.bias_sigma_radps);
  (*env)->SetDoubleArrayRegion(env, kept, 4, 3, learnt.field_offset_ut);
  (*env)->SetDoubleArrayRegion(env, kept, 7, 1, &learnt.step_scale);
  (*env)->SetDoubleArrayRegion(env, kept, 8, 1, &learnt.step_scale_sigma);
  return kept;
}

JNIEXPORT jboolean JNICALL Java_org_wayfuse_Phone_isRecorded(JNIEnv *env, jclass self, jlong handle) {
  uint32_t is_recorded = 0;
  (void)self;
  check(env, wayfuse_phone_is_recorded(of(handle)->phone, &is_recorded));
  return is_recorded ? JNI_TRUE : JNI_FALSE;
}

JNIEXPORT jlong JNICALL Java_org_wayfuse_Phone_nextScan(JNIEnv *env, jclass self, jlong handle) {
  wayfuse_scan_advice advice;
  (void)self;
  wayfuse_scan_advice_init(&advice, sizeof advice);
  if (!check(env, wayfuse_phone_next_scan(of(handle)->phone, &advice))) return -1;
  return advice.possible && advice.needed ? (jlong)advice.at_us : -1;
}

JNIEXPORT void JNICALL Java_org_wayfuse_Phone_scanStarted(JNIEnv *env, jclass self, jlong handle) {
  (void)self;
  check(env, wayfuse_phone_scan_started(of(handle)->phone));
}

JNIEXPORT jlong JNICALL Java_org_wayfuse_Phone_nowUs(JNIEnv *env, jclass self) {
  (void)env;
  (void)self;
  return (jlong)wayfuse_now_us();
}
