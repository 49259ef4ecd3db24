import java.util.concurrent.CountDownLatch;
import java.util.concurrent.TimeUnit;
import org.wayfuse.Phone;

/** Drives the binding against the test's server; leaves with 0 and "all is well", or says what failed. */
public class PhoneCheck {
  static void require(boolean condition, String what) {
    if (!condition) {
      System.err.println("failed: " + what);
      System.exit(1);
    }
  }

  static void refused(Class<? extends Exception> type, String part, Runnable call) {
    try {
      call.run();
    } catch (Exception thrown) {
      require(type.isInstance(thrown) && String.valueOf(thrown.getMessage()).contains(part), part + ", got " + thrown);
      return;
    }
    require(false, part + " was accepted");
  }

  static volatile int positions, streaming, tokens;
  static volatile String why = "";
  static final CountDownLatch placed = new CountDownLatch(1), parted = new CountDownLatch(1);

  public static void main(String[] words) throws Exception {
    Phone.Listener quiet = new Phone.Listener() {};
    refused(IllegalArgumentException.class, "url", () -> new Phone("http://nowhere", 1, "m", false, quiet));
    refused(IllegalArgumentException.class, "url", () -> new Phone(null, 1, "m", false, quiet));
    refused(IllegalArgumentException.class, "listener", () -> new Phone(words[0], 1, "m", false, null));
    Phone.Listener listener = new Phone.Listener() {
      @Override public String token() {
        ++tokens;
        return "key";
      }
      @Override public void onState(int state) {
        if (state == 3) ++streaming;
      }
      @Override public void onPosition(Phone.Position position) {
        ++positions;
        placed.countDown();
        throw new IllegalStateException("the listener's own affair");
      }
    };
    Phone phone = new Phone(words[0], 1, "java", false, listener);
    require(phone.positionNow() == null, "no position before the first");
    require(phone.nextScanUs() > 0, "a scan is due");
    phone.scanStarted();
    require(phone.nextScanUs() > Phone.nowUs(), "and not at once again");
    refused(IllegalArgumentException.class, "rss_dbm",
        () -> phone.onScanResults(5, new String[] {"00:00:00:00:00:01"}, new int[] {-312}, new int[] {2412}, new long[] {1}));
    refused(IllegalArgumentException.class, "one length",
        () -> phone.onScanResults(5, new String[] {"00:00:00:00:00:01"}, new int[] {}, new int[] {2412}, new long[] {1}));
    phone.start();
    long start = Phone.nowUs();
    for (int i = 50; i >= 0; --i) {  // the last second, lying still
      long then = 1000 * (start - 20_000 * i);
      phone.onSensorEvents(new int[] {1, 4, 2, 99}, new long[] {then, then, then, then},
          new float[] {0, 0, 9.81f, 0, 0, 0, 0, 22, -42, 1, 2, 3});
    }
    phone.onScanResults(start, new String[] {"0a:0b:0c:0d:0e:0f"}, new int[] {-50}, new int[] {2412}, new long[] {start + 5});
    require(placed.await(20, TimeUnit.SECONDS), "a position came");
    Phone.Position position = phone.positionNow();
    require(position != null && Math.abs(position.xM - 3) < 0.1 && position.floor == 2, "the position of the server");
    require(Double.isNaN(position.latitudeDeg), "no place on the map");
    require(positions > 0 && streaming == 1 && tokens == 1, "callbacks came");
    double[] learnt = phone.calibration();
    require(learnt.length == 9 && learnt[3] > 0 && Math.abs(learnt[7] - 1) < 0.3, "what was learnt: " + java.util.Arrays.toString(learnt));
    learnt[0] = 0.01;
    learnt[5] = -12;
    try (Phone next = new Phone(words[0], 1, "java", false, quiet, learnt)) {
      double[] again = next.calibration();
      require(again[0] == 0.01 && again[5] == -12 && again[7] == learnt[7], "the calibration was taken up: " + java.util.Arrays.toString(again));
    }
    refused(IllegalArgumentException.class, "calibration", () -> new Phone(words[0], 1, "java", false, quiet, new double[2]));
    learnt[7] = 9;
    refused(IllegalArgumentException.class, "step_scale", () -> new Phone(words[0], 1, "java", false, quiet, learnt));
    phone.networkChanged();
    phone.stop();
    phone.close();
    phone.close();
    try (Phone lonely = new Phone("ws://127.0.0.1:9/", 1, "java", true, new Phone.Listener() {
      @Override public void onDisconnected(String said) {
        why = said;
        parted.countDown();
      }
    })) {
      lonely.start();
      require(parted.await(20, TimeUnit.SECONDS), "the failed connection was told");
    }
    require(why.startsWith("connect"), "why there is no connection: " + why);
    refused(IllegalStateException.class, "closed", phone::start);
    System.out.println("all is well");
  }
}
