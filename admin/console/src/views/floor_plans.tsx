import type L from 'leaflet';
import { useEffect, useState } from 'preact/hooks';
import { useBuilding } from '../context';
import { FloorMap } from '../map/floor_map';
import { useFloorImage } from '../map/image_layer';
import { Choice } from '../parts/choice';
import { FloorPicture } from './floor_picture';
import { GeoreferencePanel } from './georeference_panel';
import { PlanImport } from './plan_import';

type Part = 'import' | 'picture' | 'earth';

/// The floors themselves: import a plan, lay a picture under a floor, lay the building on the earth.
export function FloorPlans() {
  const { building, floor, setFloor } = useBuilding();
  const [map, setMap] = useState<L.Map | null>(null);
  const [part, setPart] = useState<Part>('import');
  const [round, setRound] = useState(0);
  useFloorImage(map, building.id, floor, round);
  useEffect(() => setRound((n) => n + 1), [building]);
  return (
    <div class="split">
      <FloorMap floors={building.floors} floor={floor} onFloor={setFloor} onMap={setMap} label="The floor plan as it is stored." />
      <aside class="side" aria-label="Floor plans">
        <section>
          <h2>Floor plans</h2>
          <Choice name="What to change" value={part} onChange={setPart} of={[['import', 'Import'], ['picture', 'Picture'], ['earth', 'On the earth']]} />
        </section>
        {part === 'import' && <PlanImport />}
        {part === 'picture' && <FloorPicture onChange={() => setRound(round + 1)} />}
        {part === 'earth' && <GeoreferencePanel />}
      </aside>
    </div>
  );
}
