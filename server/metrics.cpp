#include "server/metrics.hpp"

#include <unistd.h>

#include <fstream>
#include <span>
#include <sstream>
#include <string_view>
#include <vector>

namespace wayfuse {
namespace {

class Exposition {
 public:
  void counter(std::string_view name, std::string_view help, double value) { row(name, help, "counter", value); }
  void gauge(std::string_view name, std::string_view help, double value) { row(name, help, "gauge", value); }
  /// `counts` per bucket, the last one beyond all bounds.
  void histogram(std::string_view name, std::string_view help, std::span<const double> bounds, std::span<const double> counts, double sum) {
    head(name, help, "histogram");
    double below = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      below += counts[i];
      text_ << "wayfuse_" << name << "_bucket{le=\"";
      if (i < bounds.size()) text_ << bounds[i];
      else text_ << "+Inf";
      text_ << "\"} " << below << '\n';
    }
    text_ << "wayfuse_" << name << "_sum " << sum << "\nwayfuse_" << name << "_count " << below << '\n';
  }
  std::string text() const { return text_.str(); }

 private:
  void row(std::string_view name, std::string_view help, std::string_view kind, double value) {
    head(name, help, kind);
    text_ << "wayfuse_" << name << ' ' << value << '\n';
  }
  void head(std::string_view name, std::string_view help, std::string_view kind) {
    text_.precision(17);
    text_ << "# HELP wayfuse_" << name << ' ' << help << "\n# TYPE wayfuse_" << name << ' ' << kind << '\n';
  }
  std::ostringstream text_;
};

double number(const std::atomic<std::uint64_t>& count) {
  return static_cast<double>(count.load(std::memory_order_relaxed));
}

double resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  double total = 0;
  double resident = 0;
  statm >> total >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

void add_sessions(Exposition& out, const SessionWorld& world) {
  const SessionCounters& c = world.counters;
  out.gauge("sessions", "Tracking sessions held, connected or resumable.", static_cast<double>(world.sessions.size()));
  out.counter("sessions_begun_total", "Tracking sessions begun.", number(c.sessions_begun));
  out.counter("sessions_resumed_total", "Tracking sessions resumed whole.", number(c.sessions_resumed));
  out.counter("sessions_not_recovered_total", "Resumes answered with recovered: false.", number(c.sessions_not_recovered));
  out.counter("sample_batches_total", "Sample batches received.", number(c.batches));
  out.counter("samples_applied_total", "Samples applied.", number(c.samples_applied));
  out.counter("samples_duplicate_total", "Samples received again and acknowledged without effect.",
              number(c.samples_duplicate));
  out.counter("samples_late_dropped_total", "Samples older than the reorder window.", number(c.samples_late_dropped));
  out.counter("sequence_gaps_total", "Gaps in sample numbers.", number(c.sequence_gaps));
  out.counter("rewinds_total", "Trackers taken back for evidence out of order.", number(c.rewinds));
  out.counter("positions_total", "Positions given.", number(c.positions));
  out.counter("no_fix_total", "Times there was no position to give.", number(c.no_fixes));
  out.counter("unsound_positions_total", "Positions withheld because they were not finite: a bug.",
              number(c.unsound_positions));
  out.counter("position_age_seconds_total", "Sum over positions of the time from evidence to answer.",
              number(c.position_age_us) * 1e-6);
  out.counter("apply_seconds_total", "Time spent in trackers.", number(c.apply_us) * 1e-6);
  out.counter("malformed_messages_total", "Frames that did not decode.", number(c.malformed_messages));
  out.counter("survey_batches_total", "Survey batches committed.", number(c.survey_batches));
  out.counter("survey_points_total", "Reference points committed.", number(c.survey_points));
  out.counter("survey_refused_total", "Survey batches refused.", number(c.survey_refused));
  out.counter("observations_total", "Observations sent.", number(c.observations));
  out.counter("zone_events_sent_total", "Zone events sent to observers over WebSocket.", number(c.zone_events));
}

void add_net(Exposition& out, const NetCounters& c) {
  out.gauge("connections", "Open connections.", number(c.connections));
  out.gauge("connections_half_open", "Open connections without a complete request.", number(c.half_open));
  out.gauge("websockets", "Open WebSocket sessions.", number(c.websockets));
  out.counter("connections_accepted_total", "Connections accepted.", number(c.accepted));
  out.counter("connections_refused_total", "Connections refused by caps and rates.", number(c.refused));
  out.counter("accept_failures_total", "Failed accepts.", number(c.accept_failures));
  out.counter("tls_failures_total", "Failed TLS handshakes.", number(c.tls_failures));
  out.counter("handshake_timeouts_total", "Connections that sent no request in time.", number(c.handshake_timeouts));
  out.counter("authentication_failures_total", "Wrong or missing keys.", number(c.authentication_failures));
  out.counter("http_answers_ok_total", "HTTP answers below 400.", number(c.http_ok));
  out.counter("http_answers_client_error_total", "HTTP answers 400 to 499.", number(c.http_client_errors));
  out.counter("http_answers_server_error_total", "HTTP answers from 500.", number(c.http_server_errors));
  out.counter("frames_received_total", "WebSocket messages received.", number(c.frames_in));
  out.counter("frames_sent_total", "WebSocket messages sent.", number(c.frames_out));
  out.counter("received_bytes_total", "Bytes of WebSocket messages received.", number(c.bytes_in));
  out.counter("sent_bytes_total", "Bytes of WebSocket messages sent.", number(c.bytes_out));
  out.counter("slow_consumers_closed_total", "Sessions closed because they did not read.", number(c.slow_closed));
  out.counter("dead_connections_closed_total", "Sessions closed because they gave no sign of life.", number(c.dead_closed));
  out.counter("read_pauses_total", "Times a session was held back for sending too fast.", number(c.read_pauses));
  out.counter("shed_total", "Sessions refused or observers closed for want of memory.", number(c.shed));
  out.gauge("outbox_bytes", "Bytes waiting to be written.", number(c.outbox_bytes));
}

void add_zones(Exposition& out, const ZoneWatch& zones) {
  const ZoneCounters& c = zones.counters();
  out.gauge("zones", "Zones watched.", static_cast<double>(zones.zones()));
  out.gauge("zone_occupants", "Phones in zones, each counted once a zone.", static_cast<double>(zones.occupied()));
  out.counter("zone_entries_total", "Entries into zones.", number(c.entered));
  out.counter("zone_exits_total", "Exits from zones.", number(c.left));
  out.counter("zone_transitions_withdrawn_total", "Of those, transitions that took an earlier one back.", number(c.withdrawn));
}

void add_webhooks(Exposition& out, const WebhookState& all) {
  const auto count = [](std::uint64_t value) { return static_cast<double>(value); };
  out.gauge("webhook_queue_depth", "Zone events waiting for a webhook or under way.", count(all.waiting));
  out.gauge("webhook_dead_letters", "Events no webhook took; in memory.", count(all.dead));
  out.counter("webhook_delivered_total", "Events a webhook took.", count(all.delivered));
  out.counter("webhook_failed_attempts_total", "Attempts that failed.", count(all.failed_attempts));
  out.counter("webhook_dropped_total", "Dead letters that had to make room.", count(all.dropped));
}

// How sure fixes say they are, and how right that is: the quality walks' truths inside the stated circles of the live maps.
void add_maps(Exposition& out, const SessionWorld& world, const AccessPointCounts& access_points) {
  const SessionCounters& c = world.counters;
  std::vector<double> counts;
  for (const auto& count : c.radius_counts) counts.push_back(number(count));
  out.histogram("fix_radius_meters", "Stated 68 % radius of the positions given.", SessionCounters::kRadiusBounds_m, counts,
                number(c.radius_sum_mm) * 1e-3);
  std::vector<MapQuality> measured;
  for (const auto& building : world.buildings.all()) measured.insert(measured.end(), building->qualities().begin(), building->qualities().end());
  const PooledQuality quality = pool(measured);
  out.gauge("quality_walks", "Quality walks the live maps were measured by.", static_cast<double>(quality.walks));
  if (quality.instants > 0) {
    out.gauge("quality_error_mean_meters", "Mean error of the live maps on their quality walks.", quality.mean_m);
    out.gauge("quality_floor_hit_ratio", "Share of those answers on the right floor.", quality.floor_hit);
    out.gauge("calibration_68_ratio", "Share of truths inside the stated 68 % circle: 0.68 when the circles are honest.", quality.in68);
    out.gauge("calibration_95_ratio", "Share of truths inside the stated 95 % circle: 0.95 when the circles are honest.", quality.in95);
  }
  out.gauge("access_points_ok", "Access points as surveyed, by live traffic.", static_cast<double>(access_points.ok));
  out.gauge("access_points_vanished", "Access points that are due and not heard.", static_cast<double>(access_points.vanished));
  out.gauge("access_points_moved", "Access points heard elsewhere than surveyed.", static_cast<double>(access_points.moved));
  out.gauge("access_points_power_changed", "Access points louder or fainter than surveyed.", static_cast<double>(access_points.power_changed));
  out.gauge("access_points_new", "Access points the survey does not know.", static_cast<double>(access_points.fresh));
  out.gauge("access_points_distrusted", "Access points left out of map and likelihood.", static_cast<double>(access_points.distrusted));
}

}  // namespace

std::string metrics_text(const SessionWorld& sessions, const NetCounters& net, const MemoryBudget& budget,
                         const BuildingKeeper& buildings, const ZoneWatch& zones, const WebhookSender& webhooks,
                         const AccessPointCounts& access_points, bool ready) {
  Exposition out;
  out.gauge("ready", "1 when the server takes sessions.", ready ? 1 : 0);
  out.gauge("buildings", "Buildings on the shelf.", static_cast<double>(sessions.buildings.all().size()));
  out.gauge("buildings_failed", "Buildings that could not be made ready.", static_cast<double>(buildings.failures().size()));
  out.counter("radio_map_builds_total", "Radio maps built or tried.", static_cast<double>(buildings.rebuilds()));
  out.gauge("memory_budget_used_ratio", "Counted memory over its limit.", budget.used());
  out.gauge("resident_memory_bytes", "Resident memory of the process.", resident_bytes());
  add_sessions(out, sessions);
  add_net(out, net);
  add_maps(out, sessions, access_points);
  add_zones(out, zones);
  add_webhooks(out, webhooks.total());
  return out.text();
}

}  // namespace wayfuse
