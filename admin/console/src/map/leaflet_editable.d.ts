declare module "leaflet-editable";
