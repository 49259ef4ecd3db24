// From zero to a moving dot in Java. On Android the lines marked (A) are your SensorEventListener and scan receiver.
//
//   java -cp wayfuse.jar:. -Djava.library.path=... MovingDot ws://127.0.0.1:8420/v1/session KEY 1
import org.wayfuse.Phone;

public class MovingDot {
  public static void main(String[] words) throws InterruptedException {
    Phone.Listener listener = new Phone.Listener() {
      @Override public String token() { return words[1]; }
      @Override public void onFault(int code, String what) { System.err.println(what); }
    };
    try (Phone phone = new Phone(words[0], Long.parseLong(words[2]), "example", false, listener)) {
      phone.start();
      for (int frame = 0; frame < 60 * (words.length > 3 ? Integer.parseInt(words[3]) : 60); ++frame) {
        long now = Phone.nowUs();
        phone.onSensorEvent(Phone.ACCELEROMETER, 1000 * now, new float[] {0, 0, 9.81f});      // (A)
        phone.onSensorEvent(Phone.GYROSCOPE, 1000 * now, new float[] {0, 0, 0});              // (A)
        phone.onSensorEvent(Phone.MAGNETIC_FIELD, 1000 * now, new float[] {0, 22, -42});      // (A)
        if (frame % 120 == 0) {                                                               // (A), of the demo building
          String[] bssids = {"00:1b:2c:f0:b5:31", "00:1b:2c:6f:7b:01", "00:1b:2c:4e:66:e1"};
          phone.onScanResults(now, bssids, new int[] {-47, -51, -79}, new int[] {5260, 5500, 5500}, new long[] {now, now, now});
        }
        Phone.Position dot = phone.positionNow();
        if (dot != null && frame % 60 == 59) {
          System.out.printf("%.2f m, %.2f m, floor %d, within %.1f m%n", dot.xM, dot.yM, dot.floor, dot.radius68M);
        }
        Thread.sleep(16);
      }
    }
  }
}
