#include "server/webhooks/webhook_sender.hpp"

#include <curl/curl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <stdexcept>

#include "server/webhooks/signature.hpp"
#include "server/webhooks/target_guard.hpp"

namespace wayfuse {
namespace {

constexpr std::size_t kUnderWayMost = 16;
constexpr long kAttempt_ms = 10'000;
constexpr long kConnect_ms = 5'000;
constexpr int kLongestSleep_ms = 1000;
constexpr std::size_t kEventsAtOnce = 64;
constexpr long kGone = 410;
constexpr std::size_t kAnswerMost = 64 * 1024;

}  // namespace

/// The requests under way. Thread: the sender's, but for wake().
class WebhookSender::Transfers {
 public:
  struct Finished {
    WebhookDelivery delivery;
    std::string failure;       ///< empty = delivered
    bool final = false;
  };

  explicit Transfers(bool private_targets) : private_targets_(private_targets) {
    static const struct Library {
      Library() { curl_global_init(CURL_GLOBAL_DEFAULT); }
    } library;
    multi_ = curl_multi_init();
    if (!multi_) throw std::runtime_error("libcurl does not start");
  }
  ~Transfers() {
    for (const auto& [easy, one] : under_way_) curl_multi_remove_handle(multi_, easy);
    under_way_.clear();
    curl_multi_cleanup(multi_);
  }
  Transfers(const Transfers&) = delete;
  Transfers& operator=(const Transfers&) = delete;

  std::size_t size() const { return under_way_.size(); }
  void wake() { curl_multi_wakeup(multi_); }

  void begin(WebhookDelivery delivery, UnixTime now) {
    auto one = std::make_unique<One>();
    one->delivery = std::move(delivery);
    one->delivery.sent_at = now;
    one->private_targets = private_targets_;
    CURL* easy = one->easy.get();
    const std::string timestamp = std::to_string(now.time_since_epoch().count() / 1'000'000);
    const WebhookDelivery& sent = one->delivery;
    curl_slist* list = nullptr;
    for (const std::string& line : {std::string("content-type: application/json"), std::string("expect:"), "webhook-id: " + sent.id,
                                    "webhook-timestamp: " + timestamp,
                                    "webhook-signature: " + webhook_signature(sent.secret, sent.id, timestamp, sent.body)}) {
      list = curl_slist_append(list, line.c_str());
    }
    one->headers.reset(list);
    curl_easy_setopt(easy, CURLOPT_URL, sent.url.c_str());
    curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, private_targets_ ? "https,http" : "https");
    curl_easy_setopt(easy, CURLOPT_FOLLOWLOCATION, 0L);
    curl_easy_setopt(easy, CURLOPT_PROXY, "");
    curl_easy_setopt(easy, CURLOPT_HTTPHEADER, list);
    curl_easy_setopt(easy, CURLOPT_POST, 1L);
    curl_easy_setopt(easy, CURLOPT_POSTFIELDS, sent.body.data());
    curl_easy_setopt(easy, CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(sent.body.size()));
    curl_easy_setopt(easy, CURLOPT_USERAGENT, "wayfuse");
    curl_easy_setopt(easy, CURLOPT_TIMEOUT_MS, kAttempt_ms);
    curl_easy_setopt(easy, CURLOPT_CONNECTTIMEOUT_MS, kConnect_ms);
    curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(easy, CURLOPT_OPENSOCKETFUNCTION, open_socket);
    curl_easy_setopt(easy, CURLOPT_OPENSOCKETDATA, one.get());
    curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, pass_over);
    curl_easy_setopt(easy, CURLOPT_WRITEDATA, one.get());
    curl_multi_add_handle(multi_, easy);
    under_way_[easy] = std::move(one);
  }

  std::vector<Finished> finished() {
    int running = 0;
    curl_multi_perform(multi_, &running);
    std::vector<Finished> all;
    for (int left = 0; const CURLMsg* message = curl_multi_info_read(multi_, &left);) {
      if (message->msg != CURLMSG_DONE) continue;
      CURL* easy = message->easy_handle;
      const CURLcode result = message->data.result;
      const auto found = under_way_.find(easy);
      all.push_back(outcome(*found->second, result));
      curl_multi_remove_handle(multi_, easy);
      under_way_.erase(found);
    }
    return all;
  }

  void sleep(int most_ms) { curl_multi_poll(multi_, nullptr, 0, most_ms, nullptr); }

 private:
  struct One {
    std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> easy{curl_easy_init(), curl_easy_cleanup};
    std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)> headers{nullptr, curl_slist_free_all};
    WebhookDelivery delivery;
    bool private_targets = false;
    bool led_inside = false;
    std::size_t answered = 0;
  };

  static curl_socket_t open_socket(void* data, curlsocktype, curl_sockaddr* address) {
    One& one = *static_cast<One*>(data);
    if (!one.private_targets && !is_public(address->addr)) {
      one.led_inside = true;
      return CURL_SOCKET_BAD;
    }
    return ::socket(address->family, address->socktype | SOCK_CLOEXEC, address->protocol);
  }

  // What a receiver says beside its status is nobody's business; one that does not end is cut off.
  static std::size_t pass_over(char*, std::size_t size, std::size_t count, void* data) {
    One& one = *static_cast<One*>(data);
    one.answered += size * count;
    return one.answered > kAnswerMost ? 0 : size * count;
  }

  static Finished outcome(One& one, CURLcode result) {
    long status = 0;
    curl_off_t took_us = 0;
    curl_easy_getinfo(one.easy.get(), CURLINFO_RESPONSE_CODE, &status);
    curl_easy_getinfo(one.easy.get(), CURLINFO_TOTAL_TIME_T, &took_us);
    one.delivery.status = static_cast<int>(status);
    one.delivery.took = Duration(took_us);
    Finished finished{std::move(one.delivery), {}, false};
    if (one.led_inside) {
      finished.failure = "the name leads into a private network";
    } else if (result != CURLE_OK && !(result == CURLE_WRITE_ERROR && one.answered > kAnswerMost)) {
      finished.failure = curl_easy_strerror(result);
    } else if (status < 200 || status > 299) {
      finished.failure = "answered " + std::to_string(status);
      finished.final = status == kGone;
    }
    return finished;
  }

  const bool private_targets_;
  CURLM* multi_ = nullptr;
  std::map<CURL*, std::unique_ptr<One>> under_way_;
};

WebhookSender::WebhookSender(DatabaseDirectory& store, ZoneControl& zones, const Clock& clock, WebhookSettings settings, std::uint64_t seed)
    : store_(store),
      zones_(zones),
      clock_(clock),
      settings_(settings),
      queue_(settings, Random(seed)),
      taken_through_(zones.newest_event()),
      transfers_(std::make_unique<Transfers>(settings.private_targets)) {}

WebhookSender::~WebhookSender() { stop(); }

void WebhookSender::start() {
  listening_ = zones_.on_event([this] { wake(); });
  thread_ = std::thread([this] { work(); });
}

void WebhookSender::stop() {
  listening_.reset();
  stopping_ = true;
  wake();
  if (thread_.joinable()) thread_.join();
}

void WebhookSender::wake() { transfers_->wake(); }

void WebhookSender::work() {
  while (!stopping_) {
    take_events();
    for (Transfers::Finished& finished : transfers_->finished()) {
      const std::lock_guard lock(mutex_);
      if (finished.failure.empty()) {
        queue_.done(finished.delivery);
      } else {
        queue_.failed(std::move(finished.delivery), std::move(finished.failure), finished.final, clock_.now());
      }
    }
    Duration wait = std::chrono::milliseconds(kLongestSleep_ms);
    while (transfers_->size() < kUnderWayMost) {
      std::optional<WebhookDelivery> next;
      {
        const std::lock_guard lock(mutex_);
        next = queue_.take(clock_.now());
        const auto due = queue_.next_due();
        if (!next && due) wait = std::clamp(Duration(*due - clock_.now()), Duration{0}, wait);
      }
      if (!next) break;
      transfers_->begin(*std::move(next), clock_.wall_now());
    }
    // Rounded up, or the last millisecond before a time is spent spinning.
    transfers_->sleep(static_cast<int>((wait + std::chrono::microseconds(999)) / std::chrono::milliseconds(1)));
  }
}

void WebhookSender::take_events() {
  for (;;) {
    const auto news = zones_.events_after(taken_through_, {}, kEventsAtOnce);
    if (news.through == taken_through_) return;
    taken_through_ = news.through;
    const std::lock_guard lock(mutex_);
    for (const NumberedZoneEvent& event : news.events) queue_.offer(event, clock_.now());
  }
}

Result<void> WebhookSender::check_target(const std::string& url) const { return check_webhook_url(url, settings_.private_targets); }

void WebhookSender::webhooks_changed(BuildingId building) {
  store_.with_building(building, [this, building](Result<BuildingDatabase*> database) {
    if (!database) return put_webhooks(building, {});
    if (const auto webhooks = (*database)->webhooks()) put_webhooks(building, *webhooks);
  });
}

void WebhookSender::put_webhooks(BuildingId building, const std::vector<WebhookRecord>& webhooks) {
  const std::lock_guard lock(mutex_);
  queue_.put_webhooks(building, webhooks);
}

WebhookState WebhookSender::state(BuildingId building, std::uint64_t webhook) const {
  const std::lock_guard lock(mutex_);
  return queue_.state(building, webhook);
}

std::vector<DeadLetter> WebhookSender::dead_letters(BuildingId building, std::uint64_t webhook) const {
  const std::lock_guard lock(mutex_);
  return queue_.dead_letters(building, webhook);
}

std::vector<WebhookAttempt> WebhookSender::attempts(BuildingId building, std::uint64_t webhook) const {
  const std::lock_guard lock(mutex_);
  return queue_.attempts(building, webhook);
}

std::uint64_t WebhookSender::retry_dead_letters(BuildingId building, std::uint64_t webhook, const std::string& event) {
  std::uint64_t count = 0;
  {
    const std::lock_guard lock(mutex_);
    count = queue_.retry_dead_letters(building, webhook, event, clock_.now());
  }
  wake();
  return count;
}

WebhookState WebhookSender::total() const {
  const std::lock_guard lock(mutex_);
  return queue_.total();
}

}  // namespace wayfuse
