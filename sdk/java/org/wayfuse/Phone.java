package org.wayfuse;

/**
 * A phone that knows where it is: sensor events and scan results in, a position out.
 *
 * <p>Shaped for Android: sensor types, axes and time stamps are those of {@code SensorEvent}, scan ages come from
 * {@code ScanResult.timestamp}. Needs nothing of Android, so that it runs on any JVM. Every method may be called from any
 * thread; {@link Listener} is called on the phone's own thread and must not close the phone there.
 */
public final class Phone implements AutoCloseable {
  static {
    System.loadLibrary("wayfuse_jni");
  }

  /** Sensor.TYPE_* of the events that are used; others are passed over. */
  public static final int ACCELEROMETER = 1;
  public static final int MAGNETIC_FIELD = 2;
  public static final int GYROSCOPE = 4;
  public static final int PRESSURE = 6;
  public static final int MAGNETIC_FIELD_UNCALIBRATED = 14;
  public static final int GYROSCOPE_UNCALIBRATED = 16;

  /** What the phone tells; all optional. */
  public interface Listener {
    /** As the server fused it; for drawing use {@link #positionNow}. */
    default void onPosition(Position position) {}
    /** 0 idle, 1 connecting, 2 greeting, 3 streaming, 4 backing off, 5 ended. */
    default void onState(int state) {}
    /** Numbers as in proto/README.md. */
    default void onFault(int code, String what) {}
    /** A connection ended, in words; the phone tries again by itself. */
    default void onDisconnected(String why) {}
    default void onSamplesLost(long first, long last) {}
    /** Asked before every connection; null = none. */
    default String token() {
      return null;
    }
  }

  /** Where the phone is. */
  public static final class Position {
    public final long atUs;
    public final double xM, yM;
    public final int floor;
    /** NaN where the building is not on the map. */
    public final double latitudeDeg, longitudeDeg;
    public final double radius68M, radius95M;
    public final double headingRad, speedMps;
    public final long sinceFusedUs;

    Position(long atUs, double xM, double yM, int floor, double latitudeDeg, double longitudeDeg, double radius68M,
        double radius95M, double headingRad, double speedMps, long sinceFusedUs) {
      this.atUs = atUs;
      this.xM = xM;
      this.yM = yM;
      this.floor = floor;
      this.latitudeDeg = latitudeDeg;
      this.longitudeDeg = longitudeDeg;
      this.radius68M = radius68M;
      this.radius95M = radius95M;
      this.headingRad = headingRad;
      this.speedMps = speedMps;
      this.sinceFusedUs = sinceFusedUs;
    }
  }

  private static final int CALIBRATION_LENGTH = 9;
  private long handle;

  /**
   * @param building 0 = found from the access points
   * @param background Android allows a background application one scan in 30 minutes, a visible one 4 in 2 minutes
   * @throws IllegalArgumentException naming the option and what is wrong with it
   */
  public Phone(String url, long building, String deviceModel, boolean background, Listener listener) {
    this(url, building, deviceModel, background, listener, null);
  }

  /** @param calibration what {@link #calibration} gave when the application last ended; null = none */
  public Phone(String url, long building, String deviceModel, boolean background, Listener listener, double[] calibration) {
    if (listener == null) {
      throw new IllegalArgumentException("listener: null");
    }
    if (calibration != null && calibration.length != CALIBRATION_LENGTH) {
      throw new IllegalArgumentException("calibration: " + calibration.length + " numbers instead of " + CALIBRATION_LENGTH);
    }
    handle = create(url, building, deviceModel, background, listener, calibration);
  }

  public synchronized void start() {
    start(open());
  }

  public synchronized void stop() {
    stop(open());
  }

  /** From ConnectivityManager.NetworkCallback. */
  public synchronized void networkChanged() {
    networkChanged(open());
  }

  /** Events in time order: type, {@code SensorEvent.timestamp} in ns, and three values each (one counts for pressure). */
  public synchronized void onSensorEvents(int[] types, long[] timestampsNs, float[] values) {
    if (types.length != timestampsNs.length || values.length != 3 * types.length) {
      throw new IllegalArgumentException("types, timestampsNs and values do not fit together");
    }
    feedMotion(open(), types, timestampsNs, values);
  }

  /** One {@code SensorEvent}. */
  public void onSensorEvent(int type, long timestampNs, float[] values) {
    float[] three = {values[0], values.length > 1 ? values[1] : 0, values.length > 2 ? values[2] : 0};
    onSensorEvents(new int[] {type}, new long[] {timestampNs}, three);
  }

  /**
   * The list WifiManager handed over, field by field: BSSID, level, frequency, timestamp (µs since boot, when it was heard).
   *
   * @param arrivedUs {@code SystemClock.elapsedRealtimeNanos() / 1000}, or {@link #nowUs}
   */
  public synchronized void onScanResults(long arrivedUs, String[] bssids, int[] levelsDbm, int[] frequenciesMhz, long[] timestampsUs) {
    int count = bssids.length;
    if (levelsDbm.length != count || frequenciesMhz.length != count || timestampsUs.length != count) {
      throw new IllegalArgumentException("the lists are not of one length");
    }
    long[] addresses = new long[count];
    for (int i = 0; i < count; ++i) {
      addresses[i] = Long.parseLong(bssids[i].replace(":", ""), 16);
    }
    feedScan(open(), arrivedUs, addresses, levelsDbm, frequenciesMhz, timestampsUs);
  }

  public synchronized void onLocation(long timeUs, double latitudeDeg, double longitudeDeg, double accuracyM) {
    feedGnss(open(), timeUs, latitudeDeg, longitudeDeg, accuracyM);
  }

  /** Where the phone is at this moment; null before the first position. Cheap enough for every frame. */
  public synchronized Position positionNow() {
    return positionNow(open());
  }

  /**
   * What has been learnt of the phone's sensors and its walker, to be kept when the application ends: gyroscope bias (rad/s, three axes)
   * and its sigma, hard iron (µT, three axes), scale of the steps and its sigma.
   */
  public synchronized double[] calibration() {
    return calibration(open());
  }

  /** Whether an operator has what this phone sends written down: show it to whoever carries the phone. May change in mid-session. */
  public synchronized boolean isRecorded() {
    return isRecorded(open());
  }

  /** When to call WifiManager.startScan next (on the clock of {@link #nowUs}); -1 = no scan needed for now. */
  public synchronized long nextScanUs() {
    return nextScan(open());
  }

  public synchronized void scanStarted() {
    scanStarted(open());
  }

  /** The phone's monotonic clock that counts through sleep, µs. */
  public static native long nowUs();

  /** Says goodbye and frees all. */
  @Override
  public void close() {
    long closing;
    synchronized (this) {
      closing = handle;
      handle = 0;
    }
    if (closing != 0) {
      destroy(closing);
    }
  }

  private long open() {
    if (handle == 0) {
      throw new IllegalStateException("the phone is closed");
    }
    return handle;
  }

  private static native long create(String url, long building, String deviceModel, boolean background, Listener listener, double[] calibration);
  private static native void destroy(long handle);
  private static native void start(long handle);
  private static native void stop(long handle);
  private static native void networkChanged(long handle);
  private static native void feedMotion(long handle, int[] types, long[] timestampsNs, float[] values);
  private static native void feedScan(long handle, long arrivedUs, long[] bssids, int[] levelsDbm, int[] frequenciesMhz, long[] heardUs);
  private static native void feedGnss(long handle, long timeUs, double latitudeDeg, double longitudeDeg, double accuracyM);
  private static native Position positionNow(long handle);
  private static native double[] calibration(long handle);
  private static native boolean isRecorded(long handle);
  private static native long nextScan(long handle);
  private static native void scanStarted(long handle);
}
