// sanitizer_control DEFECT: has that defect, which the sanitizer of this build must report. Built in the sanitized
// presets alone; tests/CMakeLists.txt says what each must print.

#include <atomic>
#include <climits>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <memory>
#include <thread>
#include <vector>

namespace {

/// SpscRing with the memory order of its indices as a parameter: `relaxed` publishes a slot that is not yet written.
template <std::memory_order load_order, std::memory_order store_order>
class Ring {
 public:
  [[nodiscard]] bool push(int value) {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    const std::size_t next = (head + 1) % slots_.size();
    if (next == tail_.load(load_order)) return false;
    slots_[head] = value;
    head_.store(next, store_order);
    return true;
  }
  [[nodiscard]] bool pop(int& value) {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(load_order)) return false;
    value = slots_[tail];
    tail_.store((tail + 1) % slots_.size(), store_order);
    return true;
  }

 private:
  std::vector<int> slots_ = std::vector<int>(4);
  std::atomic<std::size_t> head_{0};
  std::atomic<std::size_t> tail_{0};
};

template <std::memory_order load_order, std::memory_order store_order>
int sum_through_ring() {
  constexpr int kNumbers = 10'000;
  Ring<load_order, store_order> ring;
  std::thread producer{[&ring] {
    for (int number = 0; number < kNumbers; ++number) {
      while (!ring.push(number)) std::this_thread::yield();
    }
  }};
  int sum = 0;
  for (int taken = 0; taken < kNumbers; ++taken) {
    int number = 0;
    while (!ring.pop(number)) std::this_thread::yield();
    sum += number;
  }
  producer.join();
  return sum;
}

volatile int one = 1;  // not known to the compiler

int past_the_end() {
  const auto values = std::make_unique<int[]>(4);
  return values[3 + static_cast<std::size_t>(one)];
}

int after_release() {
  auto value = std::make_unique<volatile int>(7);
  volatile int* const dangling = value.get();
  value.reset();
  return *dangling;
}

int overflow() { return INT_MAX + one; }

int leak() {
  int* volatile lost = new int{one};
  const int value = *lost;
  lost = nullptr;
  return value;
}

}  // namespace

int main(int argc, char** argv) {
  const char* const defect = argc > 1 ? argv[1] : "";
  const auto is = [defect](const char* name) { return std::strcmp(defect, name) == 0; };
  int result = 0;
  if (is("weak_ring")) {
    result = sum_through_ring<std::memory_order_relaxed, std::memory_order_relaxed>();
  } else if (is("sound_ring")) {
    result = sum_through_ring<std::memory_order_acquire, std::memory_order_release>();
  } else if (is("past_the_end")) {
    result = past_the_end();
  } else if (is("after_release")) {
    result = after_release();
  } else if (is("overflow")) {
    result = overflow();
  } else if (is("leak")) {
    result = leak();
  } else {
    std::fprintf(stderr, "no defect of the name '%s'\n", defect);
    return 64;
  }
  std::printf("came to its end: %d\n", result);
  return 0;
}
