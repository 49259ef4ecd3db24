// The C interface: checks what C cannot, turns words into types, lets nothing thrown out.
#include "wayfuse/sdk/wayfuse.h"

#include <algorithm>
#include <cstring>
#include <new>
#include <string>
#include <string_view>

#include "sdk/src/c/c_words.hpp"
#include "sdk/src/c/phone.hpp"

using namespace wayfuse;

/// The opaque handle.
struct wayfuse_phone {
  std::unique_ptr<Phone> phone;
};

namespace {

template <typename Call>
wayfuse_status guarded(Call&& call) noexcept {
  try {
    return call();
  } catch (const std::bad_alloc&) {
    return refuse(WAYFUSE_NO_MEMORY, "out of memory");
  } catch (const std::exception& thrown) {
    return refuse(WAYFUSE_INTERNAL, thrown.what());
  } catch (...) {
    return refuse(WAYFUSE_INTERNAL, "something was thrown");
  }
}

/// The same, for calls that need a phone.
template <typename Call>
wayfuse_status with_phone(wayfuse_phone* handle, Call&& call) noexcept {
  if (!handle) return refuse(WAYFUSE_NULL, "phone is NULL");
  return guarded([&] { return call(*handle->phone); });
}

PhoneTime time_of(int64_t time_us) {
  return PhoneTime{Duration{time_us}};
}

std::string token_from(wayfuse_token ask, void* user) {
  char into[4096];
  const size_t length = ask(user, into, sizeof into);
  return length <= sizeof into ? std::string(into, length) : std::string();
}

PhoneSettings settings_of(const wayfuse_options& options) {
  PhoneSettings settings;
  settings.client.role = options.role == WAYFUSE_SURVEY ? Role::kSurvey : Role::kTrack;
  settings.client.building = BuildingId{options.building};
  settings.client.device_model = string_of(options.device_model);
  settings.client.app = string_of(options.app);
  settings.client.pipeline = string_of(options.pipeline);
  if (options.on_token) {
    settings.client.token = [ask = options.on_token, user = options.user] { return token_from(ask, user); };
  } else if (options.token.length > 0) {
    settings.client.token = [token = string_of(options.token)] { return token; };
  }
  settings.link.url = string_of(options.url);
  settings.link.allow_plain = options.allow_plain != 0;
  settings.link.ca_pem = string_of(options.ca_pem);
  if (options.pin.length > 0) settings.link.pins.push_back(string_of(options.pin));
  if (options.heading_estimator.length > 0) settings.motion.heading_estimator = string_of(options.heading_estimator);
  if (options.calibration) settings.motion.calibration = calibration_of(*options.calibration);
  settings.platform = static_cast<ScanPlatform>(options.platform);
  settings.seed = options.seed;
  return settings;
}

PhoneEvents events_of(const wayfuse_options& options) {
  PhoneEvents events;
  void* const user = options.user;
  if (options.on_position) {
    events.position = [call = options.on_position, user](const FusedPosition& position) {
      const wayfuse_position told = words_of(position);
      call(user, &told);
    };
  }
  if (options.on_state) {
    events.state_changed = [call = options.on_state, user](ClientState state) {
      call(user, static_cast<wayfuse_state>(state));
    };
  }
  if (options.on_fault) {
    events.fault = [call = options.on_fault, user](const Fault& fault) {
      const std::string what = to_string(fault);
      call(user, static_cast<int32_t>(fault.code), text_of(what));
    };
  }
  if (options.on_disconnected) {
    events.disconnected = [call = options.on_disconnected, user](std::string_view why) { call(user, text_of(why)); };
  }
  if (options.on_samples_lost) {
    events.samples_lost = [call = options.on_samples_lost, user](std::uint64_t first, std::uint64_t last) {
      call(user, first, last);
    };
  }
  if (options.on_survey_stored) {
    events.survey_stored = [call = options.on_survey_stored, user](const SurveyAck& ack) {
      call(user, text_of(ack.idempotency_key), ack.stored);
    };
  }
  return events;
}

}  // namespace

extern "C" {

void wayfuse_options_init(wayfuse_options* options, size_t size) {
  init_words(options, size);
}
void wayfuse_position_init(wayfuse_position* position, size_t size) {
  init_words(position, size);
}
void wayfuse_calibration_init(wayfuse_calibration* calibration, size_t size) {
  if (!calibration) return;
  init_words(calibration, size);
  if (size >= sizeof *calibration) give_words(words_of(MotionCalibration{}), calibration);
}
void wayfuse_scan_advice_init(wayfuse_scan_advice* advice, size_t size) {
  init_words(advice, size);
}

uint32_t wayfuse_abi_version(void) {
  return WAYFUSE_ABI_VERSION;
}
wayfuse_text wayfuse_version(void) {
  return text_of(std::string_view(WAYFUSE_VERSION));
}
int64_t wayfuse_now_us(void) {
  return NetworkLoop::clock_now().time_since_epoch().count();
}
wayfuse_text wayfuse_status_text(wayfuse_status status) {
  return text_of(status_words(status));
}
wayfuse_text wayfuse_last_error(void) {
  return text_of(last_refusal());
}

wayfuse_status wayfuse_phone_create(const wayfuse_options* options, wayfuse_phone** phone) {
  if (!options || !phone) return refuse(WAYFUSE_NULL, options ? "phone is NULL" : "options is NULL");
  *phone = nullptr;
  return guarded([&] {
    wayfuse_options own;
    if (const auto copied = copy_options(*options, own); copied != WAYFUSE_OK) return copied;
    auto made = Phone::create(settings_of(own), events_of(own));
    if (!made) return refuse(WAYFUSE_BAD_OPTIONS, to_string(made.fault()));
    *phone = new wayfuse_phone{std::move(made).value()};
    return WAYFUSE_OK;
  });
}

wayfuse_status wayfuse_phone_destroy(wayfuse_phone* phone) {
  if (!phone) return WAYFUSE_OK;
  return with_phone(phone, [&](Phone& inner) {
    if (inner.on_own_thread()) return refuse(WAYFUSE_WRONG_THREAD, "destroy inside a callback");
    delete phone;
    return WAYFUSE_OK;
  });
}

wayfuse_status wayfuse_phone_start(wayfuse_phone* phone) {
  return with_phone(phone, [](Phone& inner) { return status_of(inner.start()); });
}
wayfuse_status wayfuse_phone_stop(wayfuse_phone* phone) {
  return with_phone(phone, [](Phone& inner) { return status_of(inner.stop()); });
}
wayfuse_status wayfuse_phone_network_changed(wayfuse_phone* phone) {
  return with_phone(phone, [](Phone& inner) { return status_of(inner.network_changed()); });
}

wayfuse_status wayfuse_phone_state(wayfuse_phone* phone, wayfuse_state* state) {
  if (!state) return refuse(WAYFUSE_NULL, "state is NULL");
  return with_phone(phone, [&](Phone& inner) {
    *state = static_cast<wayfuse_state>(inner.state());
    return WAYFUSE_OK;
  });
}

wayfuse_status wayfuse_phone_is_recorded(wayfuse_phone* phone, uint32_t* is_recorded) {
  if (!is_recorded) return refuse(WAYFUSE_NULL, "is_recorded is NULL");
  return with_phone(phone, [&](Phone& inner) {
    *is_recorded = inner.is_recorded() ? 1 : 0;
    return WAYFUSE_OK;
  });
}

wayfuse_status wayfuse_phone_feed_motion(wayfuse_phone* phone, const wayfuse_marg_sample* samples, size_t count) {
  if (!samples && count > 0) return refuse(WAYFUSE_NULL, "samples is NULL");
  return with_phone(phone, [&](Phone& inner) {
    for (size_t i = 0; i < count; ++i) {
      if (const auto fed = status_of(inner.feed(marg_of(samples[i]))); fed != WAYFUSE_OK) return fed;
    }
    return WAYFUSE_OK;
  });
}

wayfuse_status wayfuse_phone_feed_scan(wayfuse_phone* phone, int64_t time_us, const wayfuse_reading* readings, size_t count) {
  if (!readings && count > 0) return refuse(WAYFUSE_NULL, "readings is NULL");
  return with_phone(phone, [&](Phone& inner) {
    auto scan = scan_of(time_us, readings, count);
    return scan ? status_of(inner.feed(*scan)) : status_of(scan.fault());
  });
}

wayfuse_status wayfuse_phone_feed_gnss(wayfuse_phone* phone, int64_t time_us, double latitude_deg, double longitude_deg,
                                       double sigma_m) {
  return with_phone(phone, [&](Phone& inner) {
    return status_of(inner.feed(GnssFix{time_of(time_us), {latitude_deg, longitude_deg}, sigma_m, std::nullopt, std::nullopt}));
  });
}

wayfuse_status wayfuse_phone_position_now(wayfuse_phone* phone, wayfuse_position* position) {
  if (!position) return refuse(WAYFUSE_NULL, "position is NULL");
  return with_phone(phone, [&](Phone& inner) {
    const auto live = inner.position_now();
    if (!live) return refuse(WAYFUSE_NO_POSITION, "no fused position has come yet");
    return give_words(words_of(*live), position);
  });
}

wayfuse_status wayfuse_phone_calibration(wayfuse_phone* phone, wayfuse_calibration* calibration) {
  if (!calibration) return refuse(WAYFUSE_NULL, "calibration is NULL");
  return with_phone(phone, [&](Phone& inner) { return give_words(words_of(inner.calibration()), calibration); });
}

wayfuse_status wayfuse_phone_next_scan(wayfuse_phone* phone, wayfuse_scan_advice* advice) {
  if (!advice) return refuse(WAYFUSE_NULL, "advice is NULL");
  return with_phone(phone, [&](Phone& inner) { return give_words(words_of(inner.next_scan()), advice); });
}

wayfuse_status wayfuse_phone_scan_started(wayfuse_phone* phone) {
  return with_phone(phone, [](Phone& inner) {
    inner.scan_started();
    return WAYFUSE_OK;
  });
}

wayfuse_status wayfuse_survey_begin_walk(wayfuse_phone* phone, wayfuse_text name) {
  if (!name.data && name.length > 0) return refuse(WAYFUSE_NULL, "name is NULL");
  return with_phone(phone, [&](Phone& inner) { return status_of(inner.begin_walk(string_of(name))); });
}

wayfuse_status wayfuse_survey_mark(wayfuse_phone* phone, int64_t time_us, double x_m, double y_m, int32_t floor,
                                   double sigma_m) {
  return with_phone(phone, [&](Phone& inner) {
    return status_of(inner.mark(time_of(time_us), Place{{x_m, y_m}, FloorOrdinal{floor}}, sigma_m));
  });
}

wayfuse_status wayfuse_survey_end_walk(wayfuse_phone* phone) {
  return with_phone(phone, [](Phone& inner) { return status_of(inner.end_walk()); });
}

wayfuse_status wayfuse_survey_begin_point(wayfuse_phone* phone, double x_m, double y_m, int32_t floor, double sigma_m) {
  return with_phone(phone, [&](Phone& inner) {
    return status_of(inner.begin_point(Place{{x_m, y_m}, FloorOrdinal{floor}}, sigma_m));
  });
}

wayfuse_status wayfuse_survey_end_point(wayfuse_phone* phone) {
  return with_phone(phone, [](Phone& inner) { return status_of(inner.end_point()); });
}

wayfuse_status wayfuse_survey_waiting(wayfuse_phone* phone, size_t* batches) {
  if (!batches) return refuse(WAYFUSE_NULL, "batches is NULL");
  return with_phone(phone, [&](Phone& inner) {
    *batches = inner.uploads_waiting();
    return WAYFUSE_OK;
  });
}

}  // extern "C"
