#include "db/writer_queue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

namespace wayfuse {
namespace {

using ::testing::ElementsAre;

// A queue whose writer is held until everything has been posted, so that nothing hangs on time. Written down on the writer
// thread: `7: 3` = a commit of three uploads to building 7, `task` = a task.
class HeldQueue {
 public:
  explicit HeldQueue(WriterQueue::Settings settings = {}) : queue_(settings, [this](BuildingId id, std::vector<PendingUpload> group) {
    done_.push_back(std::to_string(id.value) + ": " + std::to_string(group.size()));
  }) {
    queue_.post(std::nullopt, [this] { go_.get_future().wait(); });
  }

  void upload(std::uint64_t building, std::size_t points = 1) {
    PendingUpload upload{{building}, {"key", std::vector<ReferencePoint>(points)}, [](Result<SurveyAck>) {}};
    ASSERT_TRUE(queue_.upload(upload));
  }
  void task(std::optional<BuildingId> building) {
    queue_.post(building, [this] { done_.push_back("task"); });
  }
  std::vector<std::string> finish() {
    go_.set_value();
    queue_.stop();
    return done_;
  }

 private:
  std::promise<void> go_;
  std::vector<std::string> done_;
  WriterQueue queue_;
};

TEST(WriterQueue, CommitsTogetherWhatWaitsTogether) {
  HeldQueue queue;
  for (int i = 0; i < 8; ++i) queue.upload(7);
  EXPECT_THAT(queue.finish(), ElementsAre("7: 8"));
}

TEST(WriterQueue, AGroupEndsAt256Points) {
  HeldQueue queue;
  for (int i = 0; i < 7; ++i) queue.upload(7, 100);
  EXPECT_THAT(queue.finish(), ElementsAre("7: 2", "7: 2", "7: 2", "7: 1"));
}

TEST(WriterQueue, AnUploadLargerThanAGroupGoesAlone) {
  HeldQueue queue;
  queue.upload(7, 1000);
  queue.upload(7, 1);
  EXPECT_THAT(queue.finish(), ElementsAre("7: 1", "7: 1"));
}

TEST(WriterQueue, BuildingsDoNotMixAndDoNotWaitForEachOther) {
  HeldQueue queue;
  for (const std::uint64_t building : {7, 8, 7, 8, 7}) queue.upload(building);
  EXPECT_THAT(queue.finish(), ElementsAre("7: 3", "8: 2"));
}

TEST(WriterQueue, ATaskSeesTheUploadsBeforeItAndNoneAfterIt) {
  HeldQueue queue;
  queue.upload(7);
  queue.upload(7);
  queue.task(BuildingId{7});
  queue.upload(7);
  EXPECT_THAT(queue.finish(), ElementsAre("7: 2", "task", "7: 1"));
}

TEST(WriterQueue, ATaskOfAnotherBuildingDoesNotSplitAGroup) {
  HeldQueue queue;
  queue.upload(7);
  queue.task(BuildingId{8});
  queue.upload(7);
  queue.task(std::nullopt);
  queue.upload(7);
  EXPECT_THAT(queue.finish(), ElementsAre("7: 2", "task", "task", "7: 1"));
}

}  // namespace
}  // namespace wayfuse
