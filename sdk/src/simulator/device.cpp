#include "sdk/src/simulator/device.hpp"

#include <algorithm>
#include <stdexcept>

namespace wayfuse::simulator {
namespace {

Device model(const char* name, double offset_db, double gain, double sensitivity_dbm, double rate_hz, double noise, bool barometer) {
  Device device;
  device.model = name;
  device.rss_offset_db = offset_db;
  device.rss_gain = gain;
  device.sensitivity_dbm = sensitivity_dbm;
  device.rate_hz = rate_hz;
  device.acceleration_noise_mps2 *= noise;
  device.gyro_noise_radps *= noise;
  device.field_noise_ut *= noise;
  device.barometer = barometer;
  return device;
}

}  // namespace

const std::vector<Device>& device_models() {
  //                                                   offset  gain  hears to   rate  noise  barometer
  static const std::vector<Device> models = {model("stand-in A", 0.0, 1.00, -91, 100, 1.0, true),
                                             model("stand-in B", -4.0, 0.95, -90, 50, 1.0, true),
                                             model("stand-in C", -1.5, 0.90, -89, 50, 1.5, false),
                                             model("stand-in D", 3.5, 1.10, -92, 200, 0.7, true),
                                             model("stand-in E", -7.0, 0.80, -92, 50, 2.5, false),
                                             model("stand-in F", 1.0, 1.00, -88, 50, 1.0, false)};
  return models;
}

Device draw_device(std::string_view name, Random& random) {
  const auto& models = device_models();
  const auto found = std::ranges::find(models, name, &Device::model);
  if (found == models.end()) {
    std::string names;
    for (const Device& known : models) names += (names.empty() ? "" : ", ") + known.model;
    throw std::invalid_argument("device: no model '" + std::string(name) + "'; there are " + names);
  }
  Device device = *found;
  device.rss_offset_db += 0.8 * random.normal();
  const auto vector = [&](double sigma) {
    const double x = sigma * random.normal(), y = sigma * random.normal(), z = sigma * random.normal();
    return Vector3{x, y, z};
  };
  device.gyro_bias_radps = vector(0.004);
  device.hard_iron_ut = vector(1.5);
  Random faults = Random(random).split();   // a stream of its own: what is drawn after the device stays what it was
  device.acceleration_bias_mps2 = {0.12 * faults.normal(), 0.12 * faults.normal(), 0.12 * faults.normal()};
  return device;
}

Device draw_device(Random& random) {
  const auto& models = device_models();
  return draw_device(models[random.below(models.size())].model, random);
}

}  // namespace wayfuse::simulator
