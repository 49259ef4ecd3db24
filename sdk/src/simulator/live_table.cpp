#include "sdk/src/simulator/live_table.hpp"

#include <unistd.h>

#include <algorithm>

namespace wayfuse::simulator {
namespace {

constexpr int kBarWidth = 30;

std::string row_of(std::size_t number, const TrackedPhone& phone) {
  char line[160];
  if (!phone.position()) {
    const std::string why = phone.fault() ? to_string(*phone.fault()) : "no fix yet";
    std::snprintf(line, sizeof line, "  %2zu  %-11s %s", number, phone.device_model().c_str(), why.c_str());
    return line;
  }
  const FusedPosition& position = *phone.position();
  std::snprintf(line, sizeof line, "  %2zu  %-11s %6.1f %6.1f  %5d %8.1f %9.1f %9.1f %10.1f", number, phone.device_model().c_str(),
                position.place.point.x_m, position.place.point.y_m, position.place.floor.value, position.radius68_m,
                phone.fused().last_m(), phone.wifi_alone().last_m(), phone.reckoned().last_m());
  return line;
}

}  // namespace

std::string progress_bar(double progress) {
  const int filled = static_cast<int>(std::clamp(progress, 0.0, 1.0) * kBarWidth);
  char text[64];
  std::snprintf(text, sizeof text, "[%s%s] %3.0f %%", std::string(static_cast<std::size_t>(filled), '#').c_str(),
                std::string(static_cast<std::size_t>(kBarWidth - filled), '.').c_str(), 100 * std::clamp(progress, 0.0, 1.0));
  return text;
}

LiveTable::LiveTable(std::FILE* out) : out_(out), terminal_(isatty(fileno(out)) != 0) {}

void LiveTable::show(const std::vector<std::unique_ptr<TrackedPhone>>& phones, double progress, const std::string& clock) {
  if (!terminal_) {
    const int tenth = static_cast<int>(progress * 10);
    if (tenth == tenth_shown_) return;
    tenth_shown_ = tenth;
    const FleetErrors errors = errors_of(phones);
    std::fprintf(out_, "%s  %s  mean error so far: fused %.1f m, Wi-Fi alone %.1f m, dead reckoning %.1f m\n",
                 progress_bar(progress).c_str(), clock.c_str(), errors.fused.mean_m(), errors.wifi_alone.mean_m(),
                 errors.reckoned.mean_m());
    std::fflush(out_);
    return;
  }
  if (lines_ > 0) std::fprintf(out_, "\033[%zuA", lines_);
  std::fprintf(out_, "\033[K%s  %s\n\033[K", progress_bar(progress).c_str(), clock.c_str());
  std::fprintf(out_, "   #  phone            x      y  floor  68%% r m    fused m   Wi-Fi m   reckon. m   (error against the truth)\n");
  for (std::size_t i = 0; i < phones.size(); ++i) std::fprintf(out_, "\033[K%s\n", row_of(i + 1, *phones[i]).c_str());
  lines_ = phones.size() + 2;
  std::fflush(out_);
}

FleetErrors errors_of(const std::vector<std::unique_ptr<TrackedPhone>>& phones) {
  FleetErrors errors;
  for (const auto& phone : phones) {
    errors.fused.append(phone->fused());
    errors.wifi_alone.append(phone->wifi_alone());
    errors.reckoned.append(phone->reckoned());
    errors.samples_lost += phone->samples_lost();
  }
  return errors;
}

void print_errors(std::FILE* out, const FleetErrors& errors, bool compared) {
  std::fprintf(out, "\nError against the truth, metres          mean  median     p90   floor right   positions\n");
  const auto row = [&](const char* name, const ErrorLog& log) {
    std::fprintf(out, "  %-34s %8.2f %7.2f %7.2f %11.1f %% %11zu\n", name, log.mean_m(), log.percentile_m(0.5),
                 log.percentile_m(0.9), 100 * log.floor_share(), log.count());
  };
  row("fused", errors.fused);
  if (compared) {
    row("Wi-Fi alone", errors.wifi_alone);
    row("dead reckoning from the true start", errors.reckoned);
  }
  if (errors.samples_lost > 0) std::fprintf(out, "  %llu samples were lost\n", static_cast<unsigned long long>(errors.samples_lost));
}

bool print_summary(std::FILE* out, const FleetErrors& errors, bool compared) {
  print_errors(out, errors, compared);
  if (!compared) return errors.fused.count() > 0;
  const bool won = errors.fused.count() > 0 && errors.fused.mean_m() < errors.wifi_alone.mean_m() &&
                   errors.fused.mean_m() < errors.reckoned.mean_m();
  std::fprintf(out, won ? "\nFusion won.\n" : "\nFusion did NOT win.\n");
  return won;
}

}  // namespace wayfuse::simulator
