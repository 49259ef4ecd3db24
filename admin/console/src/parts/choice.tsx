/// One of a few, all in sight: radio buttons that look like a switch.
export function Choice<T extends string>({ name, of, value, onChange }: { name: string; of: [T, string][]; value: T; onChange: (value: T) => void }) {
  return (
    <div class="choice" role="radiogroup" aria-label={name}>
      {of.map(([each, text]) => (
        <label key={each}><input type="radio" name={name} value={each} checked={each === value} onChange={() => onChange(each)} />{text}</label>
      ))}
    </div>
  );
}
